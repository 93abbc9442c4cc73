"""What one pose says of a body: which way it faces, how long its bones are, whether it is upright.

Plain floats where a handful of numbers is quicker so than as arrays: all of this runs every
control period.
"""

import math

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.human.skeleton import BONE_CHILD, BONE_PARENT, INDEX

Array = NDArray[np.float64]

SEEN = 0.3
"""A joint below this confidence is not used; what it moves is held."""

_L_HIP, _R_HIP = INDEX["l_hip"], INDEX["r_hip"]
_L_SHOULDER, _R_SHOULDER = INDEX["l_shoulder"], INDEX["r_shoulder"]
_L_ANKLE, _R_ANKLE = INDEX["l_ankle"], INDEX["r_ankle"]
_L_TOE, _R_TOE = INDEX["l_toe"], INDEX["r_toe"]
_PELVIS, _CHEST = INDEX["pelvis"], INDEX["chest"]
_LEGS = [tuple(INDEX[f"{s}_{j}"] for j in ("hip", "knee", "ankle")) for s in "lr"]
_UPRIGHT_JOINTS = (_L_SHOULDER, _R_SHOULDER, *_LEGS[0], *_LEGS[1])


def body_heading(joint_pos_w: Array, confidence: Array) -> tuple[float, float]:
    """Heading (rad) in the world of the lower body and its weight (m; 0 when nothing shows it).

    joint_pos_w (19, 3) m, confidence (19,).

    Both feet, the line of the hips, and a little of the shoulders, so that noise on one short
    line matters less. In real twists of the trunk the shoulders turned 100 degrees, the hips 60,
    the feet 15: what turns least weighs most.
    """
    p, c = joint_pos_w.tolist(), confidence.tolist()
    fx = fy = 0.0
    for left, right, share in ((_L_HIP, _R_HIP, 1.0), (_L_SHOULDER, _R_SHOULDER, 0.25)):
        if c[left] >= SEEN and c[right] >= SEEN:
            fx += share * (p[left][1] - p[right][1])
            fy -= share * (p[left][0] - p[right][0])
    for toe, ankle in ((_L_TOE, _L_ANKLE), (_R_TOE, _R_ANKLE)):
        if c[toe] >= SEEN and c[ankle] >= SEEN:
            fx += p[toe][0] - p[ankle][0]
            fy += p[toe][1] - p[ankle][1]
    return math.atan2(fy, fx), math.hypot(fx, fy)


def bone_lengths(joint_pos_w: Array, confidence: Array) -> tuple[Array, NDArray[np.bool_]]:
    """Lengths (..., 18) m of the bones of poses (..., 19, 3), and which were seen (..., 18)."""
    bones = joint_pos_w[..., BONE_CHILD, :] - joint_pos_w[..., BONE_PARENT, :]
    length = np.sqrt(np.einsum("...i,...i->...", bones, bones))
    sure = np.minimum(confidence[..., BONE_CHILD], confidence[..., BONE_PARENT]) >= SEEN
    return length, sure & (length > 1e-3)


def is_upright(pose: HumanPose) -> bool:
    """Trunk within 12 degrees of vertical, both legs straight under it, shoulders over the feet.

    Straight: the hip is above the ankle by at least 95 % of the leg's length. Shoulders and hips
    face within 15 degrees of each other and, where the feet are seen, within 25 of them.
    """
    p, c = pose.joint_pos_w.tolist(), pose.confidence.tolist()
    if min(c[j] for j in _UPRIGHT_JOINTS) < SEEN:
        return False
    trunk = [a - b for a, b in zip(p[_CHEST], p[_PELVIS], strict=True)]
    if trunk[2] < math.cos(math.radians(12.0)) * math.hypot(*trunk):
        return False
    for hip, knee, ankle in _LEGS:
        leg = math.dist(p[hip], p[knee]) + math.dist(p[knee], p[ankle])
        if p[hip][2] - p[ankle][2] < 0.95 * leg:
            return False
    facing = _facing(p[_L_HIP], p[_R_HIP])
    twist = _facing(p[_L_SHOULDER], p[_R_SHOULDER]) - facing
    if abs(wrapped(twist)) > math.radians(15.0):
        return False
    if min(c[_L_TOE], c[_R_TOE]) < SEEN:
        return True
    fx, fy = (p[_L_TOE][i] - p[_L_ANKLE][i] + p[_R_TOE][i] - p[_R_ANKLE][i] for i in (0, 1))
    return abs(wrapped(math.atan2(fy, fx) - facing)) < math.radians(25.0)


def _facing(left: list[float], right: list[float]) -> float:
    """The way (rad) that somebody faces whose left and right are these points."""
    return math.atan2(right[0] - left[0], left[1] - right[1])


def wrapped(angle: float) -> float:
    """An angle (rad) in [-pi, pi); plain floats, which `geometry.wrap_angle` is slow for."""
    return (angle + math.pi) % (2.0 * math.pi) - math.pi
