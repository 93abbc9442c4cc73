"""What a user tunes while driving: tilt gain, dead zone, speeds; and how each one acts."""

import math
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError, unknown_name
from studio.geometry import scalars
from studio.reference.stances import JOINT_SPEED
from studio.reference.standing import FULL_TILT
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

MAX_TILT = float(FULL_TILT)
"""The trunk is never tilted further from its neutral than this: the paper's range, and as far as
standing legs reach. People twist by 100 degrees; mappers then say 48, and feet are torn off."""
LEVEL, STEEP = 0.03, 0.08
"""m a metre: slopes of 1.7 and 4.6 degrees."""
LIMITS: dict[str, tuple[float, float]] = {
    "tilt_gain": (0.0, 2.0),
    "dead_zone": (0.0, 0.5),
    "speed_cap": (0.0, 1.5),
    "joint_speed": (math.radians(60.0), math.radians(480.0)),
}
"""Ranges of the operator's sliders: a factor of the tilt, rad of tilt, m/s, rad/s."""


@dataclass(frozen=True, kw_only=True)
class RetargetSettings:
    """tilt_gain: times the trunk's tilt. dead_zone: rad of tilt that is ignored, so that a person
    who sways does not rock the robot. speed_cap: m/s, walking is slowed to this by shorter strides.
    joint_speed: rad/s that a standing or sitting reference's joints may reach on a level floor, its
    trunk in proportion (`on_slope`); a trot has limits of its own (`stances.JOINT_SPEED`).
    """

    tilt_gain: float = 1.0
    dead_zone: float = 0.0
    speed_cap: float = float("inf")
    joint_speed: float = JOINT_SPEED["stand"]

    def with_gain(self, name: str, value: float) -> "RetargetSettings":
        """The same but for one slider: errors as `checked_gain`."""
        return replace(self, **{name: checked_gain(name, value)})


def checked_gain(name: str, value: float) -> float:
    """The value, if it is within the range of a name of LIMITS, and in its unit.

    Raises StudioError otherwise.
    """
    if name not in LIMITS:
        raise unknown_name("gain", name, LIMITS)
    low, high = LIMITS[name]
    if not low <= value <= high:
        raise StudioError(f"{name} must be between {low} and {high}, not {value}")
    return float(value)


def joint_speed(degrees_a_second: float) -> float:
    """`--max-joint-speed` in rad/s. StudioError outside its range."""
    low, high = (round(math.degrees(end)) for end in LIMITS["joint_speed"])
    if not low <= degrees_a_second <= high:
        raise StudioError(
            f"--max-joint-speed must be between {low} and {high} degrees a second, "
            f"not {degrees_a_second:g}"
        )
    return math.radians(degrees_a_second)


def on_slope(joint_speed: float, slope: Array) -> float:
    """rad/s that is left of `joint_speed` where the floor rises by `slope` (2,) m a metre.

    Up to LEVEL all of it, from STEEP on no more than the paper's: a paw that is up before the
    trunk is over the other feet tips the robot over there.
    """
    share = min(max((float(np.hypot(*slope)) - LEVEL) / (STEEP - LEVEL), 0.0), 1.0)
    return joint_speed + share * (min(joint_speed, JOINT_SPEED["stand"]) - joint_speed)


def shape_tilt(quat: Array, neutral: Array, settings: RetargetSettings) -> Array:
    """The trunk (4,) with its rotation from `neutral` (4,) less the dead zone, scaled, bounded.

    Continuous at the edge of the dead zone; both quaternions are in the state's frame.
    """
    turn = scalars.mul(quat.tolist(), scalars.conj(neutral.tolist()))
    vec = scalars.rotvec(turn)
    angle = math.sqrt(vec[0] ** 2 + vec[1] ** 2 + vec[2] ** 2)
    shaped = min(settings.tilt_gain * max(0.0, angle - settings.dead_zone), MAX_TILT)
    scale = shaped / max(angle, 1e-9)
    shrunk = scalars.from_rotvec([scale * v for v in vec])
    return np.array(scalars.mul(shrunk, neutral.tolist()))


def cap_stride(
    joint_pos: Array, speed: float, settings: RetargetSettings, gain: float = 1.0
) -> Array:
    """Joint angles (12,) with strides `gain` times as long, but no faster than the speed cap.

    speed: m/s, of the joints as given. Feet keep their height; their excursion from under the
    thigh joint is scaled, to the side only ever shortened.
    """
    share = min(gain, settings.speed_cap / max(speed, 1e-6))
    if share == 1.0:
        return joint_pos
    foot = kinematics.foot_pos_b(joint_pos)
    home = a1.HIP_OFFSET[:, :2] + np.stack([np.zeros(4), a1.SIDE * a1.THIGH_OFFSET], axis=-1)
    foot[:, :2] = home + (foot[:, :2] - home) * [share, min(share, 1.0)]
    return kinematics.leg_ik(foot)[0]
