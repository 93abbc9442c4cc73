"""The torch twin of `studio.retarget.mapper`: the networks that are trained, and their export."""

from collections.abc import Mapping
from itertools import pairwise
from typing import Any

import numpy as np
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from studio.geometry import scalars
from studio.retarget.mapper import JOINT_HALF, JOINT_MID, NUM_OUTPUTS, RATES
from studio.retarget.network import INPUT_CLIP, LEAK
from studio.training.losses import Motion


def mlp(sizes: tuple[int, ...], seed: int) -> nn.Sequential:
    """Linear layers of these sizes with leaky ReLU between, He-initialised from a seed.

    The last layer starts small, so that training starts from the neutral pose.
    """
    generator = torch.Generator().manual_seed(seed)
    layers: list[nn.Module] = []
    for i, (n_in, n_out) in enumerate(pairwise(sizes)):
        linear = nn.Linear(n_in, n_out)
        last = i == len(sizes) - 2
        with torch.no_grad():
            scale = (0.1 if last else 1.0) * (2.0 / n_in) ** 0.5
            linear.weight.copy_(torch.randn(n_out, n_in, generator=generator) * scale)
            linear.bias.zero_()
        layers += [linear] if last else [linear, nn.LeakyReLU(float(LEAK))]
    return nn.Sequential(*layers)


class MapperNet(nn.Module):
    """Mapper and contact network over inputs (N, 3F) that share one normaliser."""

    mean: Tensor
    scale: Tensor
    rate_scale: Tensor
    neutral_quat: Tensor
    joint_mid: Tensor
    joint_half: Tensor

    def __init__(
        self,
        mean: NDArray,
        scale: NDArray,
        rate_scale: NDArray,
        neutral_quat: NDArray,
        *,
        hidden: int = 192,
        contact_hidden: int = 64,
        seed: int = 0,
    ) -> None:
        super().__init__()
        width = len(mean)
        self.contact_width = 2 * width // 3
        self.trunk = mlp((width, hidden, hidden, hidden, NUM_OUTPUTS), seed)
        self.contact = mlp((self.contact_width, contact_hidden, contact_hidden, 4), seed + 1)
        for name, value in (
            ("mean", mean),
            ("scale", scale),
            ("rate_scale", rate_scale),
            ("neutral_quat", neutral_quat),
            ("joint_mid", JOINT_MID),
            ("joint_half", JOINT_HALF),
        ):
            self.register_buffer(name, torch.tensor(np.asarray(value), dtype=torch.float32))

    def normalize(self, triplet: Tensor) -> Tensor:
        """As `Mapper.normalize`."""
        return ((triplet - self.mean) / self.scale).clamp(-float(INPUT_CLIP), float(INPUT_CLIP))

    def forward(self, x: Tensor) -> tuple[Motion, Tensor]:
        """Motion and contact probability (N, 4) of normalised inputs (N, 3F)."""
        out = self.trunk(x)
        raw = out[:, 12:16] + torch.tensor([1.0, 0.0, 0.0, 0.0])
        rates = out[:, 16:] * self.rate_scale
        motion = Motion(
            joint_pos=self.joint_mid + self.joint_half * torch.tanh(out[:, :12]),
            quat=quat_mul(nn.functional.normalize(raw, dim=-1), self.neutral_quat.expand_as(raw)),
            joint_vel=rates[:, RATES["joint_vel"]],
            joint_acc=rates[:, RATES["joint_acc"]],
            lin_vel=rates[:, RATES["base_lin_vel"]],
            lin_acc=rates[:, RATES["base_lin_acc"]],
            ang_vel=rates[:, RATES["base_ang_vel"]],
            ang_acc=rates[:, RATES["base_ang_acc"]],
        )
        return motion, torch.sigmoid(self.contact(x[:, : self.contact_width]))

    @staticmethod
    def from_tensors(tensors: Mapping[str, NDArray]) -> "MapperNet":
        """The inverse of `export`: a trained expert, to be trained further."""
        net = MapperNet(
            *(tensors[name] for name in ("mean", "scale", "rate_scale", "neutral_quat")),
            hidden=tensors["trunk.0.weight"].shape[1],
            contact_hidden=tensors["contact.0.weight"].shape[1],
        )
        with torch.no_grad():
            for name, part in (("trunk", net.trunk), ("contact", net.contact)):
                linears = [layer for layer in part if isinstance(layer, nn.Linear)]
                for i, linear in enumerate(linears):
                    linear.weight.copy_(torch.from_numpy(tensors[f"{name}.{i}.weight"].T.copy()))
                    linear.bias.copy_(torch.from_numpy(tensors[f"{name}.{i}.bias"].copy()))
        return net

    def export(self) -> dict[str, NDArray]:
        """The arrays `Mapper.from_tensors` reads; weights transposed to (in, out)."""
        tensors: dict[str, NDArray] = {}
        for name, net in (("trunk", self.trunk), ("contact", self.contact)):
            linears = [layer for layer in net if isinstance(layer, nn.Linear)]
            for i, linear in enumerate(linears):
                weight = linear.weight.detach().T.contiguous()
                tensors[f"{name}.{i}.weight"] = weight.numpy().copy()
                tensors[f"{name}.{i}.bias"] = linear.bias.detach().numpy().copy()
        for name in ("mean", "scale", "rate_scale", "neutral_quat"):
            tensors[name] = getattr(self, name).numpy().copy()
        return tensors


def quat_mul(a: Tensor, b: Tensor) -> Tensor:
    """Hamilton product of wxyz quaternions (N, 4), R_a_c = R_a_b R_b_c; for gradients."""
    parts: tuple[Any, Any] = (a.unbind(-1), b.unbind(-1))
    return torch.stack(scalars.mul(*parts), dim=-1)
