"""Joint angles to the smallest gap between two links of the A1, its links drawn as capsules.

Links that share a joint never count, nor do the links of one leg: within the joint limits its calf
folds beside its hip without touching it (tested). The simulator's geoms are these same capsules.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.robot import a1, legs

Array = NDArray[np.float64]


class Capsule(NamedTuple):
    """A segment with a radius, in the frame of its link; a sphere where start equals end."""

    name: str
    link: str
    start: tuple[float, float, float]
    end: tuple[float, float, float]
    radius: float


def _capsules() -> tuple[Capsule, ...]:
    x, y = a1.TRUNK_CAPSULE_X, a1.TRUNK_CAPSULE_Y
    out = [
        Capsule(f"trunk_{side}", "trunk", (-x, s * y, 0.0), (x, s * y, 0.0), a1.TRUNK_RADIUS)
        for side, s in (("right", -1.0), ("left", 1.0))
    ]
    for leg, s in zip(a1.LEGS, a1.SIDE):
        knee, foot = (0.0, 0.0, -a1.THIGH_LENGTH), (0.0, 0.0, -a1.CALF_LENGTH)
        zero, hip_end = (0.0, 0.0, 0.0), (0.0, float(s) * a1.HIP_CAPSULE_LENGTH, 0.0)
        out += [
            Capsule(f"{leg}_hip", f"{leg}_hip", zero, hip_end, a1.HIP_RADIUS),
            Capsule(f"{leg}_thigh", f"{leg}_thigh", zero, knee, a1.THIGH_RADIUS),
            Capsule(f"{leg}_calf", f"{leg}_calf", zero, foot, a1.CALF_RADIUS),
            Capsule(f"{leg}_foot", f"{leg}_calf", foot, foot, a1.FOOT_RADIUS),
        ]
    return tuple(out)


CAPSULES: tuple[Capsule, ...] = _capsules()


def _pairs() -> list[tuple[int, int]]:
    out = []
    for i, first in enumerate(CAPSULES):
        for j in range(i + 1, len(CAPSULES)):
            second = CAPSULES[j]
            same_leg = first.link[:2] == second.link[:2]
            hip_on_trunk = first.link == "trunk" and second.link.endswith("_hip")
            both_hips = first.link.endswith("_hip") and second.link.endswith("_hip")
            if not (same_leg or hip_on_trunk or both_hips):
                out.append((i, j))
    return out


PAIRS: tuple[tuple[int, int], ...] = tuple(_pairs())
"""Indices into CAPSULES of every pair that can touch."""

_I, _J = np.array(PAIRS).T
_LINK = np.array([a1.LINKS.index(c.link) for c in CAPSULES])
_START = np.array([c.start for c in CAPSULES])
_END = np.array([c.end for c in CAPSULES])
_RADIUS = np.array([c.radius for c in CAPSULES])
_GAP = _RADIUS[_I] + _RADIUS[_J]
_EPS = 1e-12
_TINY = 1e-300
"""Keeps a segment of no length from a division by zero; a short one still has two ends."""


def link_capsules(joint_pos: ArrayLike) -> tuple[Array, Array, Array]:
    """Starts and ends (..., N, 3) of CAPSULES in the base frame, and their radii (N,) m."""
    pos, quat = legs.link_frames_b(joint_pos)
    pos, quat = pos[..., _LINK, :], quat[..., _LINK, :]
    start, end = (pos + geometry.quat_rotate(quat, v) for v in (_START, _END))
    return start, end, _RADIUS


def lowest_point(base_pos: ArrayLike, base_quat: ArrayLike, joint_pos: ArrayLike) -> float:
    """Height m, world, of the robot's lowest point; base (3,), (4,), joints (12,)."""
    start, end, radius = link_capsules(joint_pos)
    ends = legs.to_world(base_pos, base_quat, np.concatenate([start, end]))
    return float(np.min(ends[:, 2] - np.tile(radius, 2)))


def pair_distances(joint_pos: ArrayLike) -> Array:
    """Gap (..., len(PAIRS)) m of every pair of capsules; negative is penetration."""
    start, end, _ = link_capsules(joint_pos)
    gap = segment_distance(start[..., _I, :], end[..., _I, :], start[..., _J, :], end[..., _J, :])
    return gap - _GAP


def self_collision_distance(joint_pos: ArrayLike) -> Array:
    """Smallest gap (...) m between two links of joint_pos (..., 12); negative is penetration."""
    return np.min(pair_distances(joint_pos), axis=-1)


def segment_distance(p1: Array, q1: Array, p2: Array, q2: Array) -> Array:
    """Distance (...) m between the segments p1-q1 and p2-q2, each (..., 3).

    The closest points p1 + s d1 and p2 + t d2 minimise a convex quadratic over the unit square:
    its minimum along s for the free t, t clipped, then s again for that t.
    """
    d1, d2, r = q1 - p1, q2 - p2, p1 - p2
    dot = _dot
    a, e, b = dot(d1, d1), dot(d2, d2), dot(d1, d2)
    c, f = dot(d1, r), dot(d2, r)
    det = a * e - b * b
    s = np.where(det > _EPS, _clip01((b * f - c * e) / np.maximum(det, _EPS)), 0.0)
    t = _clip01((b * s + f) / np.maximum(e, _TINY))
    s = _clip01((b * t - c) / np.maximum(a, _TINY))
    gap = r + s[..., None] * d1 - t[..., None] * d2
    return np.sqrt(dot(gap, gap))


def _dot(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 0] + u[..., 1] * v[..., 1] + u[..., 2] * v[..., 2]


def _clip01(x: Array) -> Array:
    return np.minimum(np.maximum(x, 0.0), 1.0)
