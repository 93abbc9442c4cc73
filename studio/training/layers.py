"""A network's layers with room for one batch: outputs, and gradients by the chain rule.

Autograd keeps a graph and asks for fresh memory for every product; here both are laid out once.
"""

import torch
from torch import Tensor, nn


class Layers:
    """Linear layers with ReLU between them, of one `nn.Sequential`, for up to `rows` samples.

    `forward` keeps what `backward` needs: they come in pairs, on one thread, without autograd.
    What they return is overwritten by the next call.
    """

    def __init__(self, network: nn.Module, rows: int) -> None:
        self.linear = [m for m in network.modules() if isinstance(m, nn.Linear)]
        self._out = [torch.empty(rows, layer.out_features) for layer in self.linear]
        self._slope = [torch.empty(rows, layer.out_features) for layer in self.linear[:-1]]
        self._x = torch.empty(0)

    def forward(self, x: Tensor) -> Tensor:
        """(n, out) of x (n, in)."""
        self._x = x
        for layer, room in zip(self.linear, self._out, strict=True):
            out = room[: len(self._x)]
            torch.addmm(layer.bias, x, layer.weight.t(), out=out)
            x = out if layer is self.linear[-1] else out.relu_()
        return x

    def backward(self, slope: Tensor) -> None:
        """Write dL/dW = gᵀ x and dL/db = Σ g into the weights' `.grad`; slope: dL/d out (n, out).

        From layer to layer g ← (g W) where the layer below was not cut off by its ReLU.
        """
        n = len(self._x)
        for k in reversed(range(len(self.linear))):
            layer = self.linear[k]
            below = self._out[k - 1][:n] if k else self._x
            assert layer.weight.grad is not None
            assert layer.bias.grad is not None
            torch.mm(slope.t(), below, out=layer.weight.grad)
            torch.sum(slope, 0, out=layer.bias.grad)
            if k:
                room = self._slope[k - 1][:n]
                torch.mm(slope, layer.weight, out=room)
                slope = torch.ops.aten.threshold_backward.grad_input(
                    room, below, 0.0, grad_input=room
                )
