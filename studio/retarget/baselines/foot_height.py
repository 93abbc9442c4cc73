"""Contact by foot height alone: what the paper tried first and found jumpy."""

import numpy as np
from numpy.typing import NDArray

from studio.robot import kinematics

Array = NDArray[np.float64]

THRESHOLD = 0.01
"""m above the lowest foot."""


def contact_by_height(base_quat: Array, joint_pos: Array, threshold: float = THRESHOLD) -> Array:
    """Contacts (N, 4), 0 or 1: feet of mapped poses no higher than `threshold` over the lowest.

    base_quat (N, 4) and joint_pos (N, 12) as mapped; the base's own height is not known.
    """
    feet = kinematics.foot_pos_w(np.zeros(3), base_quat, joint_pos)[..., 2]
    return (feet - feet.min(axis=-1, keepdims=True) <= threshold).astype(np.float64)
