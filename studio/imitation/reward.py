"""What tracking is worth: the paper's reward, one small pure function for each term.

r = 0.9 · r_pose · r_foot · r_rootpos · r_rootori · r_support + 0.1 · r_acc, every term
exp(−s · err²) (the paper prints +s, which would diverge). Errors are sums over joints (rad²) and
feet (m²); all functions take a leading axis N and return (N,) in (0, 1].
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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


def polygon_distance(
    point: Array, vertices: Array, used: NDArray[np.bool_], min_contacts: int = 3
) -> Array:
    """(N,) m from points (N, 2) to the hull of the used ones of (N, 4, 2), 0 inside.

    Vertices are the feet in the order FR, FL, RR, RL; those not `used` (N, 4) are left out. With
    fewer than `min_contacts` the distance is defined as zero (the paper). The distance to the hull
    of few points is the least over all segments between used ones, and zero inside any triangle.
    """
    n = len(point)
    best = np.full(n, np.inf)
    for i in range(4):
        for j in range(i + 1, 4):
            edge = vertices[:, j] - vertices[:, i]
            along = np.sum((point - vertices[:, i]) * edge, axis=-1)
            s = np.clip(along / np.maximum(np.sum(edge**2, axis=-1), 1e-12), 0.0, 1.0)
            gap = point - vertices[:, i] - s[:, None] * edge
            d = np.hypot(gap[:, 0], gap[:, 1])
            best = np.where(used[:, i] & used[:, j], np.minimum(best, d), best)
    inside = np.zeros(n, dtype=bool)
    for triangle in ((0, 1, 2), (0, 1, 3), (0, 2, 3), (1, 2, 3)):
        a, b, c = (vertices[:, k] - point for k in triangle)
        turns = np.stack([_cross(a, b), _cross(b, c), _cross(c, a)], axis=-1)
        within = np.all(turns >= 0.0, axis=-1) | np.all(turns <= 0.0, axis=-1)
        inside |= within & used[:, list(triangle)].all(axis=-1)
    enough = used.sum(axis=-1) >= min_contacts
    return np.where(enough & ~inside, best, 0.0)


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
