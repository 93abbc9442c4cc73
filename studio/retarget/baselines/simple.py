"""The simplest honest methods a mapper is compared with: nearest pair, ridge, contact by height."""

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.baselines.frames import Targets, unstack
from studio.retarget.mapper import NUM_RATES, Mapped
from studio.retarget.network import clipped_z, z_scores
from studio.robot import kinematics

Array = NDArray[np.float64]

THRESHOLD = 0.01
"""m above the lowest foot, up to which `contact_by_height` takes a foot to stand."""


class StandStill:
    """The neutral pose of a state, whatever the person does: what doing nothing scores."""

    def __init__(self, state: StateName) -> None:
        self._rest = NEUTRAL[state]

    def __call__(self, triplet: NDArray) -> Mapped:
        """The same for each triplet (N, 3F)."""
        count, rest = len(triplet), self._rest
        return Mapped(
            joint_pos=np.tile(rest.joint_pos, (count, 1)),
            base_quat=np.tile(rest.base_quat, (count, 1)),
            rates=np.zeros((count, NUM_RATES)),
            contact_prob=np.tile(rest.foot_contact, (count, 1)),
        )


class NearestPair:
    """The robot frame of the most similar training frame: a lookup, no learning.

    Keeps every pair; the metric is the Euclidean one of z-scored triplets.
    """

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


class Ridge:
    """The best linear map from triplets to robot frames.

    W = (Z^T Z + penalty N I)^-1 Z^T Y over z-scored triplets Z with a constant column.
    """

    def __init__(self, triplet: NDArray, targets: Targets, penalty: float = 1e-3) -> None:
        self._mean, self._scale = z_scores(triplet)
        z = self._inputs(triplet)
        gram = z.T @ z + penalty * len(z) * np.diag([*([1.0] * (z.shape[1] - 1)), 0.0])
        self._weight = np.linalg.solve(gram, z.T @ targets.stacked())

    def __call__(self, triplet: NDArray) -> Mapped:
        """The linear estimate for each triplet (N, 3F)."""
        return unstack(self._inputs(triplet) @ self._weight)

    def _inputs(self, triplet: NDArray) -> Array:
        z = clipped_z(np.asarray(triplet, np.float64), self._mean, self._scale)
        return np.concatenate([z, np.ones((len(z), 1))], axis=1)


def contact_by_height(base_quat: Array, joint_pos: Array, threshold: float = THRESHOLD) -> Array:
    """Contact by foot height alone: what the paper tried first and found jumpy.

    Contacts (N, 4), 0 or 1: feet of mapped poses no higher than `threshold` over the lowest.

    base_quat (N, 4) and joint_pos (N, 12) as mapped; the base's own height is not known.
    """
    feet = kinematics.foot_pos_w(np.zeros(3), base_quat, joint_pos)[..., 2]
    return (feet - feet.min(axis=-1, keepdims=True) <= threshold).astype(np.float64)
