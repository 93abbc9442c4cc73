"""Nearest pair: the robot frame of the most similar training frame (a lookup, no learning)."""

import numpy as np
from numpy.typing import NDArray

from studio.retarget.baselines.base import Targets, unstack, z_scores
from studio.retarget.mapper import Mapped

Array = NDArray[np.float64]


class NearestPair:
    """Keeps every pair; the metric is the Euclidean one of z-scored triplets."""

    def __init__(self, triplet: NDArray, targets: Targets) -> None:
        self._mean, self._scale = z_scores(triplet)
        self._points = ((triplet - self._mean) / self._scale).astype(np.float32)
        self._square = np.square(self._points).sum(axis=1)
        self._rows = targets.stacked()

    def __call__(self, triplet: NDArray) -> Mapped:
        """The stored labels nearest to each triplet (N, 3F)."""
        z = ((triplet - self._mean) / self._scale).astype(np.float32)
        best = np.concatenate(
            [
                np.argmin(self._square - 2.0 * (block @ self._points.T), axis=1)
                for block in np.array_split(z, max(1, len(z) // 256))
            ]
        )
        return unstack(self._rows[best])
