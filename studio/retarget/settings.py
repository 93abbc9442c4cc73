"""What a user tunes while driving: tilt gain, dead zone, speed cap; and how each one acts."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import spatial
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

MAX_TILT = float(np.deg2rad(45.0))
"""A gain never tilts the trunk further from its neutral than this."""


@dataclass(frozen=True, kw_only=True)
class RetargetSettings:
    """tilt_gain: times the trunk's tilt. dead_zone: rad of tilt that is ignored, so that a person
    who sways does not rock the robot. speed_cap: m/s, walking is slowed to this by shorter strides.
    """

    tilt_gain: float = 1.0
    dead_zone: float = 0.0
    speed_cap: float = float("inf")


def shape_tilt(quat: Array, neutral: Array, settings: RetargetSettings) -> Array:
    """The trunk (4,) with its rotation from `neutral` (4,) shrunk by the dead zone, then scaled.

    Continuous at the edge of the dead zone; both quaternions are in the state's frame.
    """
    if settings.tilt_gain == 1.0 and settings.dead_zone == 0.0:
        return quat
    vec = spatial.quat_to_rotvec(spatial.quat_mul(quat, spatial.quat_conj(neutral)))
    angle = float(np.linalg.norm(vec))
    shaped = min(settings.tilt_gain * max(0.0, angle - settings.dead_zone), MAX_TILT)
    vec = vec * (shaped / max(angle, 1e-9))
    return spatial.quat_mul(spatial.quat_from_rotvec(vec), neutral)


def cap_stride(joint_pos: Array, speed: float, settings: RetargetSettings) -> Array:
    """Joint angles (12,) with strides shortened so that `speed` (m/s) becomes the cap at most.

    Feet keep their height; their excursion from under the thigh joint is scaled.
    """
    if speed <= settings.speed_cap:
        return joint_pos
    foot = kinematics.foot_pos_b(joint_pos)
    home = a1.HIP_OFFSET[:, :2] + np.stack([np.zeros(4), a1.SIDE * a1.THIGH_OFFSET], axis=-1)
    foot[:, :2] = home + (foot[:, :2] - home) * (settings.speed_cap / speed)
    return kinematics.leg_ik(foot)[0]
