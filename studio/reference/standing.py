"""Standing intents to poses: tilts, crouches and a raised paw over feet that stay where they are.

A pure function of the intent, vectorised over time. The feet stand at their neutral places; the
trunk takes the tilt and the height; before a front paw leaves the floor the trunk has moved so that
the centre of mass lies well inside the triangle of the other three feet. Where the legs cannot
follow (a roll of 40 degrees on top of a pitch of 40, say) the tilt is scaled down until they can.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry.time_scaling import smoothstep
from studio.reference import stances
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

CROUCH_DROP = 0.085
"""m: how far crouch 1 lowers the trunk (0.27 to 0.185 m)."""
TILT_HEIGHT = 0.24
"""m: height at which tilts reach 40 degrees on every axis (by IK: pitch needs .215 to .26)."""
FULL_TILT = np.radians(40.0)
SHIFT_BY = 0.16
"""The centre of mass has moved over the other three feet when reach has come this far."""
LIFT_FROM = 0.08
"""The paw leaves the floor from this reach on."""
SHIFT_M = 0.045
"""m: how far inside the long side of the support triangle the centre of mass is brought."""

_FEET = stances.NEUTRAL_FEET["stand"]
_DIAGONAL = np.hypot(_FEET[1, 0], _FEET[1, 1])
# From the diagonal FL-RR into the triangle FL RR RL, and mirrored for the other paw.
_SHIFT = SHIFT_M / _DIAGONAL * np.array([[-0.1308, 0.1805], [-0.1308, -0.1805]])
# Thigh and calf of a raised front leg: held forward at half height, then up.
_FORWARD, _UP = np.array([-0.45, -1.50]), np.array([-1.03, -2.09])
_SIDE_HIP = 0.70
_CLEAR = 0.06  # m: a paw first rises straight off the floor
_MAX_ERROR = 5e-4  # m, of a standing foot


def stand_poses(
    tilt: Array, crouch: Array, reach: Array, reach_side: Array
) -> tuple[Array, Array, Array]:
    """Base positions (T, 3), orientations (T, 4) and joint angles (T, 12) of standing intents.

    tilt (T, 3) rad, crouch (T,), reach and reach_side (T, 2). World frame, feet at neutral.
    """
    reach = reach_on_three_feet(np.clip(reach, 0.0, 1.0))
    side, crouch = np.clip(reach_side, -1.0, 1.0), np.clip(crouch, 0.0, 1.0)
    base, quat, joints, error = _solve(tilt, crouch, reach, side)
    bad = np.flatnonzero(error > _MAX_ERROR)
    if len(bad):
        low, high = np.zeros(len(bad)), np.ones(len(bad))
        for _ in range(6):  # bisection on the share of the tilt that the legs can follow
            middle = 0.5 * (low + high)
            error = _solve(tilt[bad] * middle[:, None], crouch[bad], reach[bad], side[bad])[3]
            low, high = (
                np.where(error <= _MAX_ERROR, middle, low),
                np.where(error <= _MAX_ERROR, high, middle),
            )
        base[bad], quat[bad], joints[bad], _ = _solve(
            tilt[bad] * low[:, None], crouch[bad], reach[bad], side[bad]
        )
    return base, quat, joints


def height(tilt: Array, crouch: Array) -> Array:
    """Height (...) m of the trunk for tilts (..., 3) rad and crouches (...).

    From the crouch's height towards TILT_HEIGHT as the tilt grows, where the legs reach furthest.
    """
    upright = a1.STAND_HEIGHT - CROUCH_DROP * crouch
    amount = np.minimum(np.linalg.norm(tilt, axis=-1) / FULL_TILT, 1.0) ** 2
    return upright + (TILT_HEIGHT - upright) * amount


def reach_on_three_feet(reach: Array) -> Array:
    """Reach (..., 2) that a stand can follow: the higher paw is raised, the other carries.

    Both raised alike leaves both down: a robot on its rear legs alone would fall.
    """
    other = reach[..., ::-1]
    lead = (reach - other) / np.maximum(reach + other, 1e-9)
    return reach * smoothstep(2.0 * lead)


def _solve(tilt: Array, crouch: Array, reach: Array, side: Array) -> tuple[Array, ...]:
    """The poses, and the largest error (T,) m of a standing foot."""
    quat = stances.tilted("stand", tilt)
    base = np.zeros((len(tilt), 3))
    base[:, 2] = height(tilt, crouch)
    joints, error = _legs(base, quat, reach, side)
    if np.any(reach > 0.0):
        weight = smoothstep(reach / SHIFT_BY)
        stay = 1.0 - np.max(weight, axis=-1, keepdims=True)
        com = _com_xy(base, quat, joints)
        wanted = weight @ _SHIFT + stay * com
        for _ in range(2):  # the raised leg moves the centre of mass: place the trunk by it
            base[:, :2] += wanted - com
            joints, error = _legs(base, quat, reach, side)
            com = _com_xy(base, quat, joints)
    return base, quat, joints, error


def _com_xy(base: Array, quat: Array, joints: Array) -> Array:
    com_b = kinematics.center_of_mass_b(joints)
    return base[:, :2] + geometry.quat_rotate(quat, com_b)[:, :2]


def _legs(base: Array, quat: Array, reach: Array, side: Array) -> tuple[Array, Array]:
    """Joint angles (T, 12), feet on the floor but for raised paws, and the worst error (T,) m."""
    u = np.clip((reach - LIFT_FROM) / (1.0 - LIFT_FROM), 0.0, 1.0)
    feet = np.broadcast_to(_FEET, (len(base), 4, 3)).copy()
    feet[:, :2, 2] += _CLEAR * smoothstep(u / 0.2)
    feet_b = geometry.quat_rotate_inverse(quat[:, None, :], feet - base[:, None, :])
    joints, error = kinematics.leg_ik(feet_b)
    # Held to the side a paw stays below the hip axis: above it the hip joint would swing it back.
    up = (np.clip(2.0 * u - 1.0, 0.0, 1.0) * (1.0 - 0.6 * np.abs(side)))[..., None]
    paw = np.concatenate(
        [_SIDE_HIP * side[..., None], _FORWARD + (_UP - _FORWARD) * up],
        axis=-1,
    )
    free = smoothstep((u - 0.04) / 0.62)[..., None]
    front = joints.reshape(-1, 4, 3)[:, :2]
    front += free * (paw - front)
    _above_floor(base, quat, joints, u)
    standing = np.concatenate([free[..., 0] <= 0.0, np.ones((len(base), 2), dtype=bool)], axis=-1)
    return joints, np.max(np.where(standing, error, 0.0), axis=-1)


def _above_floor(base: Array, quat: Array, joints: Array, u: Array) -> None:
    """Raise (in place) front paws that a bent-over trunk would push towards the floor."""
    feet = kinematics.foot_pos_w(base, quat, joints)
    least = a1.FOOT_RADIUS + 0.5 * _CLEAR * smoothstep(u / 0.2)
    low = np.any((u > 0.0) & (feet[:, :2, 2] < least), axis=-1)
    if not np.any(low):
        return
    feet = feet[low]
    feet[:, :2, 2] = np.maximum(feet[:, :2, 2], np.where(u[low] > 0.0, least[low], -np.inf))
    feet_b = geometry.quat_rotate_inverse(quat[low, None, :], feet - base[low, None, :])
    joints[low, :6] = kinematics.leg_ik(feet_b, near=joints[low])[0][:, :6]
