"""How far outside the polygon of the feet on the floor a point lies.

Points are on the plane of the floor; `along_gravity` brings the centre of mass there.
"""

from itertools import combinations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

_SEGMENTS = np.array(list(combinations(range(4), 2)))
_TRIANGLES = np.array(list(combinations(range(4), 3)))


def support_distance(point_xy: ArrayLike, foot_xy: ArrayLike, contact: ArrayLike) -> Array:
    """Distance (...) m from points (..., 2) to the hull of feet (..., 4, 2) in contact (..., 4).

    The hull of four points is the union of their triangles, and from outside the nearest point is
    on a segment: so no hull is made, and the whole batch goes at once.
    Infinite where no foot is in contact.
    """
    point = np.asarray(point_xy, dtype=np.float64)[..., None, :]
    foot, on = np.asarray(foot_xy, dtype=np.float64), np.asarray(contact) > 0.5
    near = np.where(on, np.linalg.norm(foot - point, axis=-1), np.inf)
    i, j = _SEGMENTS.T
    gap = _segment_gap(point, foot[..., i, :], foot[..., j, :])
    gap = np.where(on[..., i] & on[..., j], gap, np.inf)
    nearest = np.minimum(np.min(near, axis=-1), np.min(gap, axis=-1))
    a, b, c = (foot[..., k, :] for k in _TRIANGLES.T)
    sides = np.stack([_cross(b - a, point - a), _cross(c - b, point - b), _cross(a - c, point - c)])
    has_area = np.abs(_cross(b - a, c - a)) > 1e-12
    inside = (np.all(sides >= 0.0, axis=0) | np.all(sides <= 0.0, axis=0)) & has_area
    inside &= np.all(on[..., _TRIANGLES], axis=-1)
    return np.where(np.any(inside, axis=-1), 0.0, nearest)


def along_gravity(point_w: ArrayLike, gravity_w: ArrayLike, floor_z: float = 0.0) -> Array:
    """Where (..., 2) m the line through points (..., 3) along gravity (..., 3) meets the floor."""
    point, gravity = np.asarray(point_w, dtype=np.float64), np.asarray(gravity_w, dtype=np.float64)
    scale = (floor_z - point[..., 2:]) / gravity[..., 2:]
    return point[..., :2] + scale * gravity[..., :2]


def _segment_gap(p: Array, a: Array, b: Array) -> Array:
    d = b - a
    along = np.sum((p - a) * d, axis=-1) / np.maximum(np.sum(d * d, axis=-1), 1e-18)
    along = np.minimum(np.maximum(along, 0.0), 1.0)
    return np.linalg.norm(p - a - along[..., None] * d, axis=-1)


def _cross(u: Array, v: Array) -> Array:
    return u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0]
