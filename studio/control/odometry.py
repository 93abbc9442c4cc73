"""Joint angles, tilt and gyro of two control periods → how far the trunk moved on the ground.

The contact of a foot that stands does not slip, but the foot is a ball of radius r and rolls over
it: where the lower leg turns at (ω_x, ω_y), its centre moves at r (ω_y, −ω_x). So with c the
centres relative to the trunk in its heading frame, θ and φ the pitch and roll of the lower legs,

    p = c − r (θ, −φ)

stays where it is on the ground. With ψ the turn between the two periods the trunk has moved by

    d = median of R(−ψ) p_{t−1} − p_t over the feet that stood in both,

in the heading frame of t, each axis for itself: a foot about to lift slides back under no load, and
where three or four stand the median leaves it out. What stands is for the feet's force sensors to
say. What slips all the same costs 1 to 3 % of a straight way at nominal dynamics, 5 % of slow
turns, and 5 % under Table I (median; taken as fixed, the centres cost 7, 1 and 8 %).
"""

import numpy as np
from numpy.typing import NDArray

from studio.geometry import turn_xy
from studio.robot import a1, kinematics

Array = NDArray[np.float64]
CONTACT_GAP = 0.001
"""m between sole and ground up to which a simulated foot sensor says contact."""
_UPRIGHT = float(a1.STAND_JOINT_POS[1] + a1.STAND_JOINT_POS[2])
"""rad, a standing robot's lower legs. Rolling counts from there: what is subtracted stays within
millimetres, and turning it with the feet, as `displacement` does, costs nothing."""


def level_feet(joint_pos: Array, roll: Array, pitch: Array) -> Array:
    """(N, 4, 3) m, feet relative to the trunk, its roll and pitch (N,) rad undone, heading kept.

    joint_pos: (N, 12) rad.
    """
    feet = kinematics.foot_pos_b(joint_pos)
    x, y, z = feet[..., 0], feet[..., 1], feet[..., 2]
    cr, sr = np.cos(roll)[:, None], np.sin(roll)[:, None]
    cp, sp = np.cos(pitch)[:, None], np.sin(pitch)[:, None]
    up = sr * y + cr * z
    out = np.empty_like(feet)
    out[..., 0] = cp * x + sp * up
    out[..., 1] = cr * y - sr * z
    out[..., 2] = cp * up - sp * x
    return out


def footholds(joint_pos: Array, roll: Array, pitch: Array) -> Array:
    """(N, 4, 3) m, `level_feet` less what each foot has rolled: at rest where a foot does not slip.

    Trunk and hip axis are taken to be level: at 15° of roll that is 3 % of the rolling, which
    itself is a twelfth of the way.
    """
    hip, thigh, calf = np.moveaxis(joint_pos.reshape(-1, 4, 3), -1, 0)
    out = level_feet(joint_pos, roll, pitch)
    out[..., 0] -= a1.FOOT_RADIUS * (pitch[:, None] + thigh + calf - _UPRIGHT)
    out[..., 1] += a1.FOOT_RADIUS * (roll[:, None] + hip)
    return out


def displacement(before: Array, now: Array, turn: Array, stands: Array) -> Array:
    """(N, 2) m moved between two sets of `footholds`, in the heading frame of `now`.

    turn: (N,) rad by which the heading changed. stands: (N, 4), 1 for feet that stood in both
    periods, else 0; without any the trunk is taken to rest.
    """
    moved = turn_xy(before[..., :2], -turn[:, None]) - now[..., :2]
    stood = stands > 0.5
    count = stood.sum(axis=-1)[:, None]
    # Swinging feet last, so that the first `count` are those that stand.
    ordered = np.sort(np.where(stood[..., None], moved, np.inf), axis=1)
    low = np.take_along_axis(ordered, np.maximum(count - 1, 0)[..., None] // 2, axis=1)
    high = np.take_along_axis(ordered, count[..., None] // 2, axis=1)
    return np.where(count > 0, 0.5 * (low + high)[:, 0], 0.0)
