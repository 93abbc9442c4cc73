"""What every way of mapping frames offers, so that all are planted and scored alike."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.retarget.mapper import NUM_RATES, Mapped
from studio.robot import a1

Array = NDArray[np.float64]


class FrameMapper(Protocol):
    """Maps triplets (N, 3F) to Mapped values with N rows."""

    def __call__(self, triplet: NDArray) -> Mapped: ...


@dataclass(frozen=True, kw_only=True)
class Targets:
    """Labels of N frames: joint_pos (N, 12), base_quat (N, 4), rates (N, 36), contact (N, 4)."""

    joint_pos: NDArray
    base_quat: NDArray
    rates: NDArray
    contact: NDArray

    def stacked(self) -> Array:
        """(N, 56) float64, one row per frame."""
        parts = (self.joint_pos, self.base_quat, self.rates, self.contact)
        return np.concatenate([np.asarray(p, np.float64) for p in parts], axis=1)


def unstack(rows: Array) -> Mapped:
    """Rows (N, 56) as a Mapped: joints held to their limits, quaternions made unit."""
    return Mapped(
        joint_pos=np.clip(rows[:, :12], a1.JOINT_LOWER, a1.JOINT_UPPER),
        base_quat=geometry.normalize(rows[:, 12:16]),
        rates=rows[:, 16 : 16 + NUM_RATES],
        contact_prob=np.clip(rows[:, 16 + NUM_RATES :], 0.0, 1.0),
    )


def z_scores(triplet: NDArray) -> tuple[Array, Array]:
    """Mean and sigma (3F,) of triplets, sigmas floored as for the experts."""
    std = triplet.std(axis=0).reshape(3, -1)
    floor = 0.25 * np.median(std, axis=1, keepdims=True)
    return triplet.mean(axis=0), np.maximum(std, floor).ravel()
