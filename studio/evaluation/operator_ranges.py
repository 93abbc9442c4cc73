"""How much of real people's motion a synthetic operator's spans: ranges, and nearest frames."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.skeleton import NUM_BONES

Array = NDArray[np.float64]

LOW, HIGH = 5.0, 95.0
NEAR = (0.12, 0.3, 2.5)
"""m, m/s, m/s², RMS over the joints: about what parts 95 % of the held-out people's frames from the
nearest of the default family's, mean of the three states."""


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """Percentiles of one state's features.

    real, operator: (3, 2, F) orders q, q̇, q̈ × (5th, 95th) × features. near: (3,) share of the real
    frames with one of the operator's within NEAR. frames: real ones.
    """

    real: Array
    operator: Array
    near: Array
    frames: int

    @staticmethod
    def of(real: Array, acted: Array) -> "Ranges":
        """Of features (3, N, F) and (3, M, F)."""
        return Ranges(
            real=_percentiles(real),
            operator=_percentiles(acted),
            near=np.array([near(x, y, most) for x, y, most in zip(real, acted, NEAR)]),
            frames=real.shape[1],
        )

    @property
    def coverage(self) -> Array:
        """(3, F) share of the real range that lies inside the operator's."""
        low = np.maximum(self.real[:, 0], self.operator[:, 0])
        high = np.minimum(self.real[:, 1], self.operator[:, 1])
        width = np.maximum(self.real[:, 1] - self.real[:, 0], 1e-6)
        return np.clip((high - low) / width, 0.0, 1.0)


def near(real: Array, acted: Array, most: float) -> float:
    """Share of features (N, F) that are within `most`, RMS over the joints, of one of (M, F)."""
    x, y = real.astype(np.float32), acted.astype(np.float32)
    nearest = np.full(len(x), np.inf, np.float32)
    for part in np.array_split(y, len(y) // 5000 + 1):
        square = (x * x).sum(1)[:, None] - 2.0 * x @ part.T + (part * part).sum(1)
        nearest = np.minimum(nearest, square.min(axis=1))
    return float(np.mean(nearest <= NUM_BONES * most**2))


def _percentiles(x: Array) -> Array:
    return np.moveaxis(np.percentile(x, [LOW, HIGH], axis=1), 0, 1)
