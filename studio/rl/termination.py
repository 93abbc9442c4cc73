"""When an episode ends early: trunk on the ground, self-penetration, or a fall."""

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.robot import kinematics

Array = NDArray[np.float64]
TRUNK_HALF = np.array([0.1335, 0.097, 0.057])
"""Half extents of the A1's trunk box, m (its URDF's collision box 0.267 × 0.194 × 0.114)."""
_CORNERS = TRUNK_HALF * np.array(
    [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
)


def trunk_clearance(base_pos: Array, base_quat: Array) -> Array:
    """(N,) m, height of the lowest corner of the trunk's box over the floor z = 0.

    The last row of R is all it takes: z_corner = z + R_2 · corner.
    """
    return base_pos[..., 2] + (geometry.up_in_body(base_quat) @ _CORNERS.T).min(axis=-1)


def fallen(
    base_pos: Array, base_quat: Array, reference_quat: Array, clearance: float = 0.004
) -> NDArray[np.bool_]:
    """(N,) the trunk touches the floor (within `clearance` m) or tilts over 60° off the reference.

    `metrics.fallen`, with the trunk's contact told by its height: the batched physics has none.
    """
    low = trunk_clearance(base_pos, base_quat) < clearance
    return metrics.fallen(low, base_quat, reference_quat)


def self_penetrating(joint_pos: Array, depth: float = 0.005) -> NDArray[np.bool_]:
    """(N,) two links of the robot overlap by more than `depth` m."""
    return kinematics.self_collision_distance(joint_pos) < -depth
