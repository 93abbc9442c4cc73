"""Joints in a file's own axes → which of its axes points up, and whether it is left-handed."""

import numpy as np
from numpy.typing import NDArray

from studio.human.sensor_skeletons import axes_for
from studio.human.skeleton import INDEX

Array = NDArray[np.float64]
_CHEST = INDEX["chest"]
_LEFT, _RIGHT = ([INDEX[f"{s}_{j}"] for j in ("hip", "knee", "ankle", "toe")] for s in "lr")


def find_axes(moving: Array, rest: Array) -> tuple[Array, bool]:
    """The axes (3, 3) of a file's world, and whether it is a mirror image of ours.

    moving: (T, 19, 3) canonical joints, in file axes and units; rest: (19, 3) in its rest pose, all
    zeros where it has none. Up is where the chest mostly is above the ankles. People lie down and
    stand on their hands: where that is not +y or +z, a rest pose that clearly stands goes before.
    """
    up = _upward(np.median(_trunk(moving), axis=0))
    standing = _trunk(rest)
    length = float(np.linalg.norm(standing))
    if up not in ("y", "z") and length > 0.0 and np.abs(standing).max() > 0.9 * length:
        up = _upward(standing)
    axes = axes_for(up)
    mirrored = _feet_point_back(moving @ axes.T)
    return axes_for(up, mirrored), mirrored


def _trunk(joints: Array) -> Array:
    return joints[..., _CHEST, :] - 0.5 * (joints[..., _LEFT[2], :] + joints[..., _RIGHT[2], :])


def _upward(v: Array) -> str:
    axis = int(np.argmax(np.abs(v)))
    return ("-" if v[axis] < 0.0 else "") + "xyz"[axis]


def _feet_point_back(joints: Array) -> bool:
    """Both feet mostly point where hips, left to right, have their back: left and right are then
    swapped, as no person can do it."""
    across = joints[:, _LEFT[0], :2] - joints[:, _RIGHT[0], :2]
    facing = np.stack([across[:, 1], -across[:, 0]], axis=-1)
    feet = sum(joints[:, leg[3], :2] - joints[:, leg[2], :2] for leg in (_LEFT, _RIGHT))
    agree = np.sum(facing * feet, axis=-1)
    lengths = np.linalg.norm(facing, axis=-1) * np.linalg.norm(feet, axis=-1)
    return bool(np.median(agree + 0.5 * lengths) < 0.0)
