"""When an episode ends early: trunk on the ground, self-penetration, or a fall."""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.robot import kinematics

Array = NDArray[np.float64]
FALL_TILT = np.deg2rad(60.0)
"""Tilt from the reference's beyond which a robot counts as fallen."""
TRUNK_HALF = np.array([0.1335, 0.097, 0.057])
"""Half extents of the A1's trunk box, m (its URDF's collision box 0.267 × 0.194 × 0.114)."""
_CORNERS = TRUNK_HALF * np.array(
    [[x, y, z] for x in (-1.0, 1.0) for y in (-1.0, 1.0) for z in (-1.0, 1.0)]
)


def trunk_clearance(base_pos: Array, base_quat: Array) -> Array:
    """(N,) m, height of the lowest corner of the trunk's box over the floor z = 0.

    Row 2 of R(q) is all it takes: z_corner = z + R_2 · corner.
    """
    w, x, y, z = np.moveaxis(base_quat, -1, 0)
    row = np.stack([2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)], axis=-1)
    return base_pos[..., 2] + (row @ _CORNERS.T).min(axis=-1)


def tilt_error(base_quat: Array, reference_quat: Array) -> Array:
    """(N,) rad between the verticals seen from the two trunks: heading does not matter."""
    up_a, up_b = up_in_body(base_quat), up_in_body(reference_quat)
    cross = np.cross(up_a, up_b)
    return np.arctan2(np.linalg.norm(cross, axis=-1), np.sum(up_a * up_b, axis=-1))


def up_in_body(quat: Array) -> Array:
    """(N, 3) world z in the body frame."""
    z_axis = np.broadcast_to([0.0, 0.0, 1.0], quat.shape[:-1] + (3,))
    return geometry.quat_rotate_inverse(quat, z_axis)


def fallen(
    base_pos: Array, base_quat: Array, reference_quat: Array, clearance: float = 0.004
) -> NDArray[np.bool_]:
    """(N,) the trunk touches the floor (within `clearance` m) or tilts over 60° off the reference.

    The sitting trunk starts near vertical: the test is on the reference's tilt, not the world's.
    """
    low = trunk_clearance(base_pos, base_quat) < clearance
    return low | (tilt_error(base_quat, reference_quat) > FALL_TILT)


def self_penetrating(joint_pos: Array, depth: float = 0.005) -> NDArray[np.bool_]:
    """(N,) two links of the robot overlap by more than `depth` m."""
    return kinematics.self_collision_distance(joint_pos) < -depth
