"""What tracking is worth: the paper's reward, one small pure function for each term.

r = 0.9 · r_pose · r_foot · r_rootpos · r_rootori · r_support + 0.1 · r_acc, every term
exp(−s · err²) (the paper prints +s, which would diverge). Errors are sums over joints (rad²) and
feet (m²); all functions take a leading axis N and return (N,) in (0, 1].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.geometry import turn_xy
from studio.robot import kinematics

Array = NDArray[np.float64]
MIN_CONTACTS = 3
"""Feet below which nothing is asked of the centre of mass (the paper)."""
_TRIANGLES = np.array([[0, 1, 2], [0, 1, 3], [0, 2, 3], [1, 2, 3]])
_CORNERS = _TRIANGLES.T


@dataclass(frozen=True, kw_only=True)
class RewardConfig:
    """Scales s and weights w; s_acc is on Σ(Δq̇/Δt)² at 30 Hz (the paper leaves it open)."""

    pose: float = 1.0
    foot: float = 20.0
    root_pos: float = 20.0
    root_ori: float = 5.0
    support: float = 10.0
    acc: float = 1e-5
    main_weight: float = 0.9
    acc_weight: float = 0.1


def pose(joint_pos: Array, reference: Array, scale: float) -> Array:
    """exp(−s Σ_j (q̄_j − q_j)²) over (N, 12) rad."""
    return np.exp(-scale * np.sum((reference - joint_pos) ** 2, axis=-1))


def foot(foot_pos: Array, reference: Array, scale: float) -> Array:
    """exp(−s Σ_e ‖x̄_e − x_e‖²) over (N, 4, 3) m, base-relative in the heading frame."""
    return np.exp(-scale * np.sum((reference - foot_pos) ** 2, axis=(-2, -1)))


def root_pos(pos: Array, reference: Array, scale: float) -> Array:
    """exp(−s ‖x̄ − x‖²) of the trunk origin (N, 3) m against the re-anchored reference."""
    return np.exp(-scale * np.sum((reference - pos) ** 2, axis=-1))


def root_ori(angle: Array, scale: float) -> Array:
    """exp(−s d²), d the rotation angle (N,) rad to the re-anchored reference."""
    return np.exp(-scale * angle**2)


def support(distance: Array, scale: float) -> Array:
    """exp(−s d_sp²), d_sp (N,) m of the centre of mass outside the support polygon, 0 inside."""
    return np.exp(-scale * distance**2)


def acc(joint_vel: Array, previous: Array, dt: float, scale: float) -> Array:
    """exp(−s Σ_j ((q̇ − q̇_prev) / Δt)²) over (N, 12) rad/s."""
    return np.exp(-scale * np.sum(((joint_vel - previous) / dt) ** 2, axis=-1))


def total(terms: dict[str, Array], config: RewardConfig) -> Array:
    """(N,) reward from the six terms."""
    main = terms["pose"] * terms["foot"] * terms["root_pos"] * terms["root_ori"] * terms["support"]
    return config.main_weight * main + config.acc_weight * terms["acc"]


def support_point(
    base_pos: Array, base_quat: Array, joint_pos: Array, gravity: Array, yaw: Array
) -> Array:
    """(N, 2) m: where the centre of mass comes down along gravity, from the trunk's origin.

    base_pos (N, 3), base_quat (N, 4) and gravity (N, 3) of any length in the frame of the ground,
    z = 0; the result in the frame turned by yaw (N,) rad, like `bank.heading_feet`.
    """
    center = kinematics.center_of_mass_b(joint_pos)[:, None]
    center = kinematics.to_world(base_pos, base_quat, center)[:, 0]
    return turn_xy(kinematics.along_gravity(center, gravity) - base_pos[:, :2], -yaw)


def outside_support(
    point: Array, vertices: Array, used: NDArray[np.bool_], min_contacts: int = MIN_CONTACTS
) -> Array:
    """(N,) m from points (N, 2) to the hull of the used ones of (N, 4, 2), 0 inside.

    Vertices are the feet in the order FR, FL, RR, RL; those not `used` (N, 4) are left out. With
    fewer than `min_contacts` the distance is defined as zero (the paper).
    """
    out = np.zeros(len(point))
    rows = np.flatnonzero(used.sum(axis=-1) >= min_contacts)
    # Most points lie inside one of the triangles, and need no distance to the segments.
    a, b, c = (vertices[rows][:, corner] - point[rows, None] for corner in _CORNERS)
    turns = np.stack([_cross(a, b), _cross(b, c), _cross(c, a)])
    within = np.all(turns >= 0.0, axis=0) | np.all(turns <= 0.0, axis=0)
    inside = np.any(within & used[rows][:, _TRIANGLES].all(axis=-1), axis=-1)
    rows = rows[~inside]
    if len(rows):
        out[rows] = kinematics.support_distance(point[rows], vertices[rows], used[rows])
    return out


def _cross(a: Array, b: Array) -> Array:
    return a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
