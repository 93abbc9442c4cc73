"""A pose on the template's body, its mirror image, and the features of a neutral stand."""

import numpy as np
from numpy.typing import NDArray

from studio.human.calibration import Calibration
from studio.human.canonical import (
    ANKLES,
    FLIP_Y,
    bone_directions,
    heading_axes,
    rebuild,
)
from studio.human.pose import HumanPose
from studio.human.skeleton import (
    ANKLE_HEIGHT,
    LEG_LENGTH,
    MIRROR,
    MIRROR_BONES,
    NEUTRAL,
    NEUTRAL_DIRECTION,
)

Array = NDArray[np.float64]

MIRROR_JOINTS = np.array(MIRROR)

NEUTRAL_Q: Array = np.append((NEUTRAL[1:] - NEUTRAL[0]).ravel(), NEUTRAL[0, 2] / LEG_LENGTH)
"""(F,) q of the template's neutral stand: joints about the pelvis, m, and its height."""


def canonical_pose(pose: HumanPose, calibration: Calibration, mirror: bool = False) -> Array:
    """The person on the template's body, (19, 3) m: heading removed, pelvis at x = y = 0.

    The lower sole lies at z = 0. Bones not seen take the neutral pose's direction. `mirror` shows
    the person as a mirror would.
    """
    direction, _, seen = bone_directions(pose.joint_pos_w, pose.confidence)
    direction = np.where(
        seen[:, None], direction @ heading_axes(calibration.heading), NEUTRAL_DIRECTION
    )
    if mirror:
        direction = direction[MIRROR_BONES] * FLIP_Y
    joints = rebuild(direction)
    joints[:, 2] += ANKLE_HEIGHT - joints[ANKLES, 2].min()
    return joints


def mirror_pose(pose: HumanPose) -> HumanPose:
    """The mirror image in the source's x-z plane: left is right; twice gives the pose again."""
    return HumanPose(
        t=pose.t,
        joint_pos_w=pose.joint_pos_w[MIRROR_JOINTS] * FLIP_Y,
        confidence=pose.confidence[MIRROR_JOINTS],
    )
