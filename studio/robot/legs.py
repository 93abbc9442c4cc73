"""Joint angles to feet, link frames and centre of mass of the A1, and feet back to joint angles.

Everything is closed form and vectorised over leading batch axes; a single pose costs tens of
microseconds. Legs in the order of a1.LEGS (FR FL RR RL), angles in rad, lengths in m. In a leg's
hip frame, with hip a, thigh b, calf c, thigh and calf lengths l1, l2 and side s:

    x = -l1 sin b - l2 sin(b + c)      y = s d      z = -l1 cos b - l2 cos(b + c)

and the base frame sees Rx(a) (x, y, z) + hip offset.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.robot import a1, single

Array = NDArray[np.float64]

_L1, _L2 = a1.THIGH_LENGTH, a1.CALF_LENGTH
_Y = a1.SIDE * a1.THIGH_OFFSET
_LOWER = a1.JOINT_LOWER.reshape(4, 3)
_UPPER = a1.JOINT_UPPER.reshape(4, 3)
_THIGH_MIDDLE = 0.5 * (_LOWER[:, 1] + _UPPER[:, 1])
# i b = (-x, w, -z, y), j b = (-y, z, w, -x), k b = (-z, -y, x, w) for b = (w, x, y, z)


def _split(joint_pos: ArrayLike) -> tuple[Array, Array, Array]:
    """Hip, thigh and calf angles, each (..., 4), of joint_pos (..., 12)."""
    q = np.asarray(joint_pos, dtype=np.float64)
    assert q.shape[-1] == a1.NUM_JOINTS, f"joint_pos must be (..., 12), not {q.shape}"
    return q[..., 0::3], q[..., 1::3], q[..., 2::3]


def _from_hip_frame(a: Array, x: Array, y: Array, z: Array) -> Array:
    """Points (..., 4, 3) in the base frame of coordinates in each hip's turned frame."""
    sa, ca = np.sin(a), np.cos(a)
    out = np.empty(np.shape(x) + (3,))
    out[..., 0] = x
    out[..., 1] = y * ca - z * sa
    out[..., 2] = y * sa + z * ca
    return out + a1.HIP_OFFSET


def foot_pos_b(joint_pos: ArrayLike) -> Array:
    """Foot sphere centres (..., 4, 3) in the base frame of joint_pos (..., 12)."""
    q = np.asarray(joint_pos, dtype=np.float64)
    if q.size == a1.NUM_JOINTS == q.shape[-1]:
        return np.array(single.feet(q.ravel().tolist())).reshape(*q.shape[:-1], 4, 3)
    a, b, c = _split(q)
    return _leg_points(a, b, c)


def _leg_points(a: Array, b: Array, c: Array) -> Array:
    bc = b + c
    x = -_L1 * np.sin(b) - _L2 * np.sin(bc)
    z = -_L1 * np.cos(b) - _L2 * np.cos(bc)
    return _from_hip_frame(a, x, _Y, z)


def to_world(base_pos: ArrayLike, base_quat: ArrayLike, points_b: ArrayLike) -> Array:
    """Points (..., N, 3) from the base frame to the world: p_w = R(base_quat) p_b + base_pos."""
    points = np.asarray(points_b) @ np.swapaxes(geometry.quat_to_matrix(base_quat), -1, -2)
    return points + np.asarray(base_pos, dtype=np.float64)[..., None, :]


def foot_pos_w(base_pos: ArrayLike, base_quat: ArrayLike, joint_pos: ArrayLike) -> Array:
    """Foot sphere centres (..., 4, 3) in the world; base (..., 3), (..., 4), joints (..., 12)."""
    return to_world(base_pos, base_quat, foot_pos_b(joint_pos))


def leg_ik(foot_b: ArrayLike, near: ArrayLike | None = None) -> tuple[Array, Array]:
    """Joint angles (..., 12) that bring the feet to (..., 4, 3), knees backwards, within limits.

    Also the distance (..., 4) m between the asked and the reached foot: 0 within reach and limits,
    else the leg stops at its limits close to the target. Two hip angles may serve one foot (below
    and above the hip); the one nearer to `near` (..., 12), by default to zero, is taken.
    """
    foot = np.asarray(foot_b, dtype=np.float64)
    assert foot.shape[-2:] == (4, 3), f"foot_b must be (..., 4, 3), not {foot.shape}"
    near_hip = np.zeros(4) if near is None else _split(near)[0]
    batch = foot.shape[:-2]
    if foot.size == 12 and near_hip.shape in ((4,), (*batch, 4)):
        angles, errors = single.joints(foot.reshape(4, 3).tolist(), near_hip.ravel().tolist())
        return np.array(angles).reshape(*batch, 12), np.array(errors).reshape(*batch, 4)
    p = foot - a1.HIP_OFFSET
    x, y, z = p[..., 0], p[..., 1], p[..., 2]

    # In the plane across the hip axis the foot lies at angle `direction`, the leg at `opening`
    # from it: on one side for a foot below the hip, on the other above (a raised paw).
    depth = np.sqrt(np.maximum(y * y + z * z - _Y**2, 0.0))
    direction, opening = np.arctan2(z, y), np.arctan2(depth, _Y)
    hip = geometry.wrap_angle(np.stack([direction + opening, direction - opening]))
    hip = np.minimum(np.maximum(hip, _LOWER[:, 0]), _UPPER[:, 0])
    thigh, calf = _plane_ik(x, -y * np.sin(hip) + z * np.cos(hip))
    gap = _leg_points(hip, thigh, calf) - foot
    error = np.sqrt(np.einsum("...i,...i->...", gap, gap))
    # Equally good within a nanometre: the nearer hip angle decides.
    cost = np.where(error < np.min(error, axis=0) + 1e-9, 0.0, 10.0) + np.abs(hip - near_hip)
    above = cost[1] < cost[0]
    angles = np.stack([np.where(above, v[1], v[0]) for v in (hip, thigh, calf)], axis=-1)
    return angles.reshape(*angles.shape[:-2], 12), np.where(above, error[1], error[0])


def _plane_ik(x: Array, z: Array) -> tuple[Array, Array]:
    """Thigh and calf angles (..., 4) that bring the foot nearest to (x, z) in the leg's plane."""
    cos_calf = (x * x + z * z - _L1**2 - _L2**2) / (2.0 * _L1 * _L2)
    calf = -np.arccos(np.minimum(np.maximum(cos_calf, -1.0), 1.0))
    calf = np.minimum(np.maximum(calf, _LOWER[:, 2]), _UPPER[:, 2])
    thigh = np.arctan2(-x, -z) - np.arctan2(_L2 * np.sin(calf), _L1 + _L2 * np.cos(calf))
    thigh = geometry.wrap_angle(thigh - _THIGH_MIDDLE) + _THIGH_MIDDLE
    limited = np.minimum(np.maximum(thigh, _LOWER[:, 1]), _UPPER[:, 1])
    at_limit = limited != thigh
    if np.any(at_limit):  # the thigh stops: the calf points from the knee towards the target
        towards = np.arctan2(-x - _L1 * np.sin(limited), -z - _L1 * np.cos(limited)) - limited
        towards = geometry.wrap_angle(towards + np.pi / 2) - np.pi / 2  # into [-3/2 pi, pi/2)
        towards = np.minimum(np.maximum(towards, _LOWER[:, 2]), _UPPER[:, 2])
        calf = np.where(at_limit, towards, calf)
    return limited, calf


def leg_jacobian(joint_pos: ArrayLike) -> Array:
    """d foot_pos_b / d (hip, thigh, calf) of each leg, (..., 4, 3, 3), columns by joint."""
    a, b, c = _split(joint_pos)
    bc = b + c
    x2, z2 = -_L2 * np.sin(bc), -_L2 * np.cos(bc)
    x, z = x2 - _L1 * np.sin(b), z2 - _L1 * np.cos(b)
    sa, ca = np.sin(a), np.cos(a)
    out = np.zeros(np.shape(x) + (3, 3))
    out[..., 1, 0] = -_Y * sa - z * ca
    out[..., 2, 0] = _Y * ca - z * sa
    out[..., 0, 1], out[..., 1, 1], out[..., 2, 1] = z, x * sa, -x * ca
    out[..., 0, 2], out[..., 1, 2], out[..., 2, 2] = z2, x2 * sa, -x2 * ca
    return out


def link_frames_b(joint_pos: ArrayLike) -> tuple[Array, Array]:
    """Position (..., 13, 3) and orientation (..., 13, 4) of a1.LINKS in the base frame."""
    a, b, c = _split(joint_pos)
    batch = np.shape(a)[:-1]
    pos = np.zeros((*batch, a1.NUM_LINKS, 3))
    quat = np.zeros((*batch, a1.NUM_LINKS, 4))
    quat[..., 0, 0] = 1.0
    sa, ca = np.sin(0.5 * a), np.cos(0.5 * a)
    pos[..., 1::3, :] = a1.HIP_OFFSET
    quat[..., 1::3, 0], quat[..., 1::3, 1] = ca, sa
    zero = np.zeros_like(a)
    pos[..., 2::3, :] = _from_hip_frame(a, zero, _Y, zero)
    pos[..., 3::3, :] = _from_hip_frame(a, -_L1 * np.sin(b), _Y, -_L1 * np.cos(b))
    for first, half in ((2, 0.5 * b), (3, 0.5 * (b + c))):
        s, co = np.sin(half), np.cos(half)
        # Rx(a) Ry(2 half), the Hamilton product written out
        quat[..., first::3, 0], quat[..., first::3, 1] = ca * co, sa * co
        quat[..., first::3, 2], quat[..., first::3, 3] = ca * s, sa * s
    return pos, quat


def link_frames_w(
    base_pos: ArrayLike, base_quat: ArrayLike, joint_pos: ArrayLike
) -> tuple[Array, Array]:
    """Position (..., 13, 3) and orientation (..., 13, 4) of a1.LINKS in the world."""
    pos, quat = link_frames_b(joint_pos)
    base_quat = np.asarray(base_quat, dtype=np.float64)
    turned = geometry.quat_mul(base_quat[..., None, :], quat)
    return to_world(base_pos, base_quat, pos), turned


def center_of_mass_b(joint_pos: ArrayLike) -> Array:
    """Centre of mass (..., 3) of the whole robot in the base frame."""
    a, b, c = _split(joint_pos)
    hip_com, thigh_com, calf_com = np.moveaxis(a1.LEG_COM, 1, 0)
    bc = b + c
    masses = a1.LINK_MASS[1:4]
    # Mass-weighted sums in each hip's frame; Ry(t) v = (x cos t + z sin t, y, z cos t - x sin t).
    x = masses[0] * hip_com[:, 0] - masses[2] * _L1 * np.sin(b)
    z = masses[0] * hip_com[:, 2] - masses[2] * _L1 * np.cos(b)
    for mass, com, angle in ((masses[1], thigh_com, b), (masses[2], calf_com, bc)):
        s, co = np.sin(angle), np.cos(angle)
        x = x + mass * (com[:, 0] * co + com[:, 2] * s)
        z = z + mass * (com[:, 2] * co - com[:, 0] * s)
    y = masses[0] * hip_com[:, 1] + masses[1] * (thigh_com[:, 1] + _Y) + masses[2] * _Y
    leg_mass = np.sum(masses)
    legs = _from_hip_frame(a, x / leg_mass, y / leg_mass, z / leg_mass)
    total = leg_mass * np.sum(legs, axis=-2) + a1.TRUNK_MASS * a1.TRUNK_COM
    return total / np.sum(a1.LINK_MASS)
