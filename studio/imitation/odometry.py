"""Joint angles, tilt and gyro of two control periods → how far the trunk moved on the ground.

A foot that stands does not move: with p the feet relative to the trunk in its heading frame, ψ the
turn between the two periods and w = 1 for the feet that stood in both,

    d = Σ w (R(−ψ) p_{t−1} − p_t) / Σ w,

in the heading frame of t. What stands is for the feet's force sensors to say; slip is missed, and
costs 3 % of the way at nominal dynamics, 5 % under Table I (medians).
"""

import numpy as np
from numpy.typing import NDArray

from studio.robot import kinematics

Array = NDArray[np.float64]
CONTACT_GAP = 0.001
"""m between sole and ground up to which a simulated foot sensor says contact."""


def level_feet(joint_pos: Array, roll: Array, pitch: Array) -> Array:
    """(N, 4, 3) m, feet relative to the trunk, its roll and pitch (N,) undone, heading kept."""
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


def turned(xy: Array, angle: Array) -> Array:
    """(N, …, 2) points turned by angle (N,) rad about the vertical."""
    shape = (-1,) + (1,) * (xy.ndim - 2)
    c, s = np.cos(angle).reshape(shape), np.sin(angle).reshape(shape)
    x, y = xy[..., 0], xy[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def displacement(before: Array, now: Array, turn: Array, stands: Array) -> Array:
    """(N, 2) m moved between two sets of `level_feet`, in the heading frame of `now`.

    turn: (N,) rad by which the heading changed. stands: (N, 4), 1 for feet that stood in both
    periods; without any the trunk is taken to rest.
    """
    moved = turned(before[..., :2], -turn) - now[..., :2]
    count = stands.sum(axis=-1)
    return np.sum(stands[..., None] * moved, axis=1) / np.maximum(count, 1.0)[:, None]
