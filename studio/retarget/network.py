"""Small multi-layer perceptrons in plain numpy: weights from safetensors, one row in, one out; and
what they, and whatever is compared with them, are given: z-scores of triplets, cut off."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError

Array32 = NDArray[np.float32]
LEAK = np.float32(0.01)
"""Slope of the leaky ReLU below zero; the torch twin in `studio.training` uses the same."""


INPUT_CLIP = np.float32(5.0)
"""Sigmas beyond which an input says no more."""


def z_scores(triplet: NDArray) -> tuple[NDArray, NDArray]:
    """Mean and sigma (3F,) of triplets (N, 3F).

    A joint that hardly moves in training must not shout when somebody moves it a little: sigmas are
    floored at a share of the typical one of their block (q, q̇ or q̈).
    """
    std = triplet.std(axis=0).reshape(3, -1)
    floor = 0.25 * np.median(std, axis=1, keepdims=True)
    return triplet.mean(axis=0), np.maximum(std, floor).ravel()


def clipped_z(triplet: NDArray, mean: NDArray, scale: NDArray) -> NDArray:
    """Triplets (..., 3F) in sigmas from a mean, cut off at INPUT_CLIP."""
    return np.minimum(np.maximum((triplet - mean) / scale, -INPUT_CLIP), INPUT_CLIP)


@dataclass(frozen=True, kw_only=True)
class Mlp:
    """Linear layers with leaky ReLU between them: (..., in) -> (..., out), float32.

    weights: each (in, out), so that a row vector times the matrix is a layer; biases: each (out,).
    """

    weights: tuple[Array32, ...]
    biases: tuple[Array32, ...]

    def __call__(self, x: Array32) -> Array32:
        """The last layer's output, before any squashing."""
        for w, b in zip(self.weights[:-1], self.biases[:-1], strict=True):
            x = x @ w + b
            x = np.maximum(x, LEAK * x)
        return x @ self.weights[-1] + self.biases[-1]

    @property
    def input_dim(self) -> int:
        """Width of the rows it takes."""
        return self.weights[0].shape[0]

    @staticmethod
    def from_tensors(tensors: Mapping[str, NDArray], prefix: str) -> "Mlp":
        """Read `<prefix>.0.weight` (in, out), `<prefix>.0.bias` (out,) … until there are no more.

        Raises StudioError when there is no such network in the file.
        """
        weights: list[Array32] = []
        biases: list[Array32] = []
        while f"{prefix}.{len(weights)}.weight" in tensors:
            i = len(weights)
            weights.append(np.ascontiguousarray(tensors[f"{prefix}.{i}.weight"], np.float32))
            biases.append(np.ascontiguousarray(tensors[f"{prefix}.{i}.bias"], np.float32))
        if not weights:
            raise StudioError(
                f"these weights have no network {prefix!r}: train them again with "
                "`a1-studio train mapper`"
            )
        return Mlp(weights=tuple(weights), biases=tuple(biases))
