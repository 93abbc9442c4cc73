"""Rotations and transforms: wxyz quaternions, T_a_b with p_a = T_a_b @ p_b, heading frames.

All functions take and return float64 arrays with leading batch axes. Frames are right-handed,
z up, x forward, y left. Roll, pitch and yaw are intrinsic z-y'-x'' angles, R = Rz Ry Rx. The
formulas of products and matrices are those of `scalars`, which has them by component.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.geometry import scalars

Array = NDArray[np.float64]
IDENTITY_QUAT: Array = np.array([1.0, 0.0, 0.0, 0.0])


def normalize(v: ArrayLike, eps: float = 1e-12) -> Array:
    """Unit vectors of (..., n); a vector shorter than `eps` is divided by `eps`."""
    v = np.asarray(v, dtype=np.float64)
    return v / np.maximum(np.linalg.norm(v, axis=-1, keepdims=True), eps)


def _by_component(formula: Callable[..., Any], *operands: ArrayLike) -> Array:
    """A formula of `scalars` on the last axes of arrays; on single ones in plain floats."""
    arrays = [np.asarray(x, dtype=np.float64) for x in operands]
    if all(x.ndim == 1 for x in arrays):
        return np.array(formula(*[x.tolist() for x in arrays]))
    parts = formula(*[_components(x) for x in arrays])
    out = np.empty(np.shape(parts[0]) + (len(parts),))
    for i, part in enumerate(parts):
        out[..., i] = part
    return out


def _components(x: Array) -> list[Array]:
    return [x[..., i] for i in range(x.shape[-1])]


def quat_mul(a: ArrayLike, b: ArrayLike) -> Array:
    """Hamilton product of wxyz quaternions (..., 4)."""
    return _by_component(scalars.mul, a, b)


def quat_conj(q: ArrayLike) -> Array:
    """Conjugate (inverse, for unit quaternions) of (..., 4)."""
    return np.asarray(q, dtype=np.float64) * np.array([1.0, -1.0, -1.0, -1.0])


def quat_positive(q: ArrayLike) -> Array:
    """The representative with w >= 0 of (..., 4)."""
    q = np.asarray(q, dtype=np.float64)
    return np.where(q[..., :1] < 0.0, -q, q)


def quat_rotate(q: ArrayLike, v: ArrayLike) -> Array:
    """Rotate vectors (..., 3) by unit quaternions (..., 4): p_a = R_a_b p_b."""
    return _by_component(scalars.turn, q, v)


def quat_rotate_inverse(q: ArrayLike, v: ArrayLike) -> Array:
    """Rotate vectors (..., 3) by the inverse of unit quaternions (..., 4)."""
    return quat_rotate(quat_conj(q), v)


def quat_from_axis_angle(axis: ArrayLike, angle: ArrayLike) -> Array:
    """Quaternions (..., 4) turning by `angle` (...) rad about unit `axis` (..., 3)."""
    half = 0.5 * np.asarray(angle, dtype=np.float64)[..., None]
    return np.concatenate([np.cos(half), np.sin(half) * np.asarray(axis)], axis=-1)


def quat_from_rotvec(r: ArrayLike) -> Array:
    """Exponential map: rotation vectors (..., 3) rad to quaternions (..., 4)."""
    r = np.asarray(r, dtype=np.float64)
    angle = np.linalg.norm(r, axis=-1, keepdims=True)
    half = 0.5 * angle
    # sinc keeps the direction exact down to zero angle
    return np.concatenate([np.cos(half), 0.5 * np.sinc(half / np.pi) * r], axis=-1)


def quat_to_rotvec(q: ArrayLike) -> Array:
    """Logarithm map: unit quaternions (..., 4) to rotation vectors (..., 3), angle in [0, pi]."""
    q = quat_positive(q)
    s = np.linalg.norm(q[..., 1:], axis=-1, keepdims=True)
    angle = 2.0 * np.arctan2(s, q[..., :1])
    scale = np.where(s > 1e-12, angle / np.maximum(s, 1e-12), 2.0)
    return scale * q[..., 1:]


def quat_from_rpy(rpy: ArrayLike) -> Array:
    """Quaternions (..., 4) of roll, pitch, yaw (..., 3) rad, R = Rz(yaw) Ry(pitch) Rx(roll)."""
    half = 0.5 * np.asarray(rpy, dtype=np.float64)
    c, s = np.cos(half), np.sin(half)
    cr, cp, cy = c[..., 0], c[..., 1], c[..., 2]
    sr, sp, sy = s[..., 0], s[..., 1], s[..., 2]
    w = cr * cp * cy + sr * sp * sy
    out = np.empty(np.shape(w) + (4,))
    out[..., 0] = w
    out[..., 1] = sr * cp * cy - cr * sp * sy
    out[..., 2] = cr * sp * cy + sr * cp * sy
    out[..., 3] = cr * cp * sy - sr * sp * cy
    return out


def quat_to_rpy(q: ArrayLike) -> Array:
    """Roll, pitch, yaw (..., 3) rad of unit quaternions (..., 4); pitch in [-pi/2, pi/2]."""
    q = np.asarray(q, dtype=np.float64)
    w, x, y, z = q[..., 0], q[..., 1], q[..., 2], q[..., 3]
    roll = np.arctan2(2.0 * (w * x + y * z), 1.0 - 2.0 * (x * x + y * y))
    pitch = np.arcsin(np.clip(2.0 * (w * y - z * x), -1.0, 1.0))
    yaw = np.arctan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z))
    return np.stack([roll, pitch, yaw], axis=-1)


def quat_to_matrix(q: ArrayLike) -> Array:
    """Rotation matrices (..., 3, 3) of unit quaternions (..., 4)."""
    q = np.asarray(q, dtype=np.float64)
    if q.ndim == 1:
        return scalars.matrix(q.tolist())
    out = np.empty(q.shape[:-1] + (3, 3))
    parts = _components(q)
    for i, row in enumerate((scalars.row_x, scalars.row_y, scalars.row_z)):
        for j, part in enumerate(row(parts)):
            out[..., i, j] = part
    return out


def up_in_body(q: ArrayLike) -> Array:
    """World z in the body frame (..., 3) of unit quaternions (..., 4): the last row of R."""
    return _by_component(scalars.row_z, q)


def quat_from_matrix(m: ArrayLike) -> Array:
    """Unit quaternions (..., 4), w >= 0, of rotation matrices (..., 3, 3) (Shepperd's method)."""
    m = np.asarray(m, dtype=np.float64)
    m00, m11, m22 = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    # The four squared components times four; the largest is the safe divisor.
    sq = np.stack(
        [1 + m00 + m11 + m22, 1 + m00 - m11 - m22, 1 - m00 + m11 - m22, 1 - m00 - m11 + m22],
        axis=-1,
    )
    d = np.stack(
        [
            m[..., 2, 1] - m[..., 1, 2],
            m[..., 0, 2] - m[..., 2, 0],
            m[..., 1, 0] - m[..., 0, 1],
        ],
        axis=-1,
    )
    s01, s02, s12 = (m[..., i, j] + m[..., j, i] for i, j in ((0, 1), (0, 2), (1, 2)))
    candidates = np.stack(
        [
            np.stack([sq[..., 0], d[..., 0], d[..., 1], d[..., 2]], axis=-1),
            np.stack([d[..., 0], sq[..., 1], s01, s02], axis=-1),
            np.stack([d[..., 1], s01, sq[..., 2], s12], axis=-1),
            np.stack([d[..., 2], s02, s12, sq[..., 3]], axis=-1),
        ],
        axis=-2,
    )
    best = np.argmax(sq, axis=-1)[..., None, None]
    return quat_positive(normalize(np.take_along_axis(candidates, best, axis=-2)[..., 0, :]))


def quat_angle(a: ArrayLike, b: ArrayLike) -> Array:
    """Angle (...) rad in [0, pi] between unit quaternions, 2 acos|a . b|, exact near zero."""
    return np.linalg.norm(quat_to_rotvec(quat_mul(quat_conj(a), b)), axis=-1)


def quat_slerp(a: ArrayLike, b: ArrayLike, s: ArrayLike) -> Array:
    """Great-circle blend from a (s=0) to b (s=1), the short way; s has the batch shape."""
    delta = quat_to_rotvec(quat_mul(quat_conj(a), b))
    return quat_mul(a, quat_from_rotvec(np.asarray(s, dtype=np.float64)[..., None] * delta))


def ang_vel_b(quat: ArrayLike, dt: float) -> Array:
    """Body angular velocity (T, 3) rad/s by backward differences of quaternions (T, 4).

    The first row repeats the second (zero for a single frame).
    """
    quat = np.asarray(quat, dtype=np.float64)
    out = np.zeros(quat.shape[:-1] + (3,))
    if len(quat) > 1:
        out[1:] = quat_to_rotvec(quat_mul(quat_conj(quat[:-1]), quat[1:])) / dt
        out[0] = out[1]
    return out


def heading(q: ArrayLike) -> Array:
    """Yaw (...) rad of the body's x axis laid on the ground.

    Near vertical (the trunk of a sitting robot pitched past 60 degrees is still fine) the
    x axis loses its ground direction; there the twist about world z stands in for it.
    """
    q = np.asarray(q, dtype=np.float64)
    x_w = quat_rotate(q, np.broadcast_to([1.0, 0.0, 0.0], q.shape[:-1] + (3,)))
    flat = np.hypot(x_w[..., 0], x_w[..., 1])
    twist = 2.0 * np.arctan2(q[..., 3], q[..., 0])
    return np.where(flat > 0.05, np.arctan2(x_w[..., 1], x_w[..., 0]), wrap_angle(twist))


def heading_quat(q: ArrayLike) -> Array:
    """The heading frame of (..., 4): a rotation about world z only."""
    return quat_from_yaw(heading(q))


def quat_from_yaw(yaw: ArrayLike) -> Array:
    """Rotations (..., 4) by yaw (...) rad about z."""
    half = 0.5 * np.asarray(yaw, dtype=np.float64)
    zero = np.zeros_like(half)
    return np.stack([np.cos(half), zero, zero, np.sin(half)], axis=-1)


def turn_xy(xy: Array, angle: ArrayLike) -> Array:
    """(…, 2) turned to the left by `angle` rad about the vertical; angle: one, or (…) of them."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = xy[..., 0], xy[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def wrap_angle(a: ArrayLike) -> Array:
    """Angles wrapped to [-pi, pi)."""
    return (np.asarray(a, dtype=np.float64) + np.pi) % (2.0 * np.pi) - np.pi
