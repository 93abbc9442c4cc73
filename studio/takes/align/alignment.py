"""A person and a robot to the same channels, and to a time warp on top of the lag (`lag`).

The channels are trunk tilt, height, hands and paws, and which foot is up.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.skeleton import INDEX
from studio.robot import kinematics

Array = NDArray[np.float64]

CHANNELS: tuple[str, ...] = ("roll", "pitch", "yaw", "height", "right", "left", "step")
_HUMAN_SCALE = np.array([0.15, 0.25, 0.2, 0.08, 0.25, 0.25, 0.12])
_ROBOT_SCALE = np.array([0.15, 0.2, 0.15, 0.03, 0.08, 0.08, 0.6])
"""What one unit of each channel is worth: a movement anyone would call a movement. Weighting by
scale keeps a channel in which nothing happens from voting with its noise."""
MIN_LAG_S, MAX_LAG_S = -0.2, 1.0


@dataclass(frozen=True, kw_only=True)
class Alignment:
    """lag: s, the person is late by it (> 0). correlation: [-1, 1] at that lag.

    certainty: [0, 1], how likely the person is late by it, within a frame; 0 when nothing moves.
    """

    lag: float
    correlation: float
    certainty: float


def human_channels(joint_pos_w: Array) -> Array:
    """(T, 19, 3) m in any heading to (T, 7): CHANNELS of the person."""
    p = {name: joint_pos_w[:, i] for name, i in INDEX.items()}
    up = np.array([0.0, 0.0, 1.0])
    left = geometry.normalize((p["l_hip"] - p["r_hip"]) * [1.0, 1.0, 0.0])
    forward = np.cross(left, up)
    trunk = geometry.normalize(p["chest"] - p["pelvis"])
    shoulders = geometry.normalize((p["l_shoulder"] - p["r_shoulder"]) * [1.0, 1.0, 0.0])
    roll = -np.arcsin(np.clip(_dot(trunk, left), -1, 1))
    pitch = np.arctan2(_dot(trunk, forward), trunk[:, 2])
    yaw = np.arctan2(-_dot(shoulders, forward), _dot(shoulders, left))
    soles = np.stack([p["l_ankle"][:, 2], p["r_ankle"][:, 2]], axis=-1)
    height = p["pelvis"][:, 2] - soles.min(axis=-1)
    right = p["r_wrist"][:, 2] - p["r_shoulder"][:, 2]
    left_hand = p["l_wrist"][:, 2] - p["l_shoulder"][:, 2]
    return np.stack([roll, pitch, yaw, height, right, left_hand, soles[:, 0] - soles[:, 1]], -1)


def robot_channels(base_pos: Array, base_quat: Array, joint_pos: Array, contact: Array) -> Array:
    """Poses (T, 3) m, (T, 4), (T, 12) rad in the world and contacts (T, 4) to (T, 7): CHANNELS.

    A step is the diagonal that stands less the one that is in the air: the person's left foot
    goes with the front left and rear right.
    """
    rpy = geometry.quat_to_rpy(base_quat)
    foot = kinematics.foot_pos_w(base_pos, base_quat, joint_pos)
    yaw = np.unwrap(geometry.heading(base_quat))
    # A slow turn is a path, not a twist: take a straight line out.
    yaw = yaw - np.linspace(yaw[0], yaw[-1], len(yaw))
    step = 0.5 * (contact[:, 0] + contact[:, 3] - contact[:, 1] - contact[:, 2])
    return np.stack(
        [rpy[:, 0], rpy[:, 1], yaw, base_pos[:, 2], foot[:, 0, 2], foot[:, 1, 2], step], axis=-1
    )


def scaled_human(channels: Array) -> Array:
    """(T, 7) human channels about their median, each in units of a movement anyone would call one:
    for curves beside the robot's."""
    return (channels - np.median(channels, axis=0)) / _HUMAN_SCALE


def scaled_robot(channels: Array) -> Array:
    """(T, 7) robot channels about their median, in units as those of `scaled_human`."""
    return (channels - np.median(channels, axis=0)) / _ROBOT_SCALE


def time_warp(human: Array, robot: Array, dt: float, *, max_shift_s: float = 0.3) -> Array:
    """Dynamic time warp after the lag is taken out: (T,) s to add to robot time to read the human.

    human, robot: (T, 7) channels already in step but for it. The path is monotone, stays within
    max_shift_s of the diagonal (Sakoe-Chiba band) and pays for leaving it, so that a person in
    time is left alone; it is smoothed over 0.5 s, since nobody's tempo jumps.
    """
    n = min(len(human), len(robot))
    h, r = scaled_human(human[:n]), scaled_robot(robot[:n])
    band = max(1, round(max_shift_s / dt))
    shifts = np.arange(-band, band + 1)
    # (T, shifts), a shift at a time: an hour's human is not copied for each of them.
    cost = np.stack(
        [np.linalg.norm(h[np.clip(np.arange(n) + k, 0, n - 1)] - r, axis=-1) for k in shifts], -1
    )
    # One step of robot time moves human time by 0, 1 or 2 frames: shift changes by -1, 0 or +1.
    total, back = cost[0] + 0.2 * np.abs(shifts), np.zeros((n, len(shifts)), dtype=np.int8)
    for i in range(1, n):
        padded = np.pad(total, 1, constant_values=np.inf)
        options = np.stack([padded[:-2] + 0.3, padded[1:-1], padded[2:] + 0.3])
        choice = np.argmin(options, axis=0)
        back[i] = choice - 1
        total = cost[i] + options[choice, np.arange(len(shifts))]
    path = np.empty(n, dtype=int)
    path[-1] = int(np.argmin(total + 0.2 * np.abs(shifts)))
    for i in range(n - 1, 0, -1):
        path[i - 1] = path[i] + back[i, path[i]]
    width = max(1, round(0.5 / dt))
    smooth = np.convolve(
        np.pad(shifts[path].astype(float), width, mode="edge"), np.ones(width) / width, "same"
    )[width:-width]
    # Smoothing must not make human time run backwards.
    return np.maximum.accumulate(np.arange(n) + smooth) * dt - np.arange(n) * dt


def _dot(a: Array, b: Array) -> Array:
    return np.einsum("...i,...i->...", a, b)
