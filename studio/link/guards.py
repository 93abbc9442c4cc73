"""What the robot's side checks of its own sensors: before it rises, and in every step."""

import math
from typing import Literal

import numpy as np

from studio import geometry
from studio.robot import a1
from studio.robot.pose import RobotState

Why = Literal[
    "", "switched on", "asked to", "line silent", "tilt", "not finite", "joints", "moving"
]
"""Why a robot is limp: a closed list, in the order of its number on the wire."""

LEANS = math.sin(math.radians(60.0))
"""Sine of the lean to a side, or nose down, from which the robot has fallen. Nose up it sits."""
OVERTURNED = -math.sin(math.radians(25.0))
"""Cosine of the lean to any side from which it lies: nose up past the vertical by so much. Sitting,
it is at 70 degrees and a person leans it further."""
UPRIGHT = math.cos(math.radians(45.0))
"""A robot rises from no steeper."""
JOINT_SLACK = 0.1
"""rad beyond a joint's range that a calibrated encoder may read."""
MOVING = 1.0
"""rad/s: somebody is moving the legs."""


def finite(robot: RobotState) -> bool:
    """All that is sensed are numbers, and the quaternion turns."""
    parts = (
        robot.base_pos,
        robot.base_quat,
        robot.joint_pos,
        robot.base_ang_vel_b,
        robot.joint_vel,
    )
    return all(np.isfinite(part).all() for part in parts) and bool(robot.base_quat.any())


def unfit_to_rise(robot: RobotState) -> Why:
    """The start-up check: why its legs may not be moved now, or ""."""
    if not finite(robot):
        return "not finite"
    if geometry.up_in_body(robot.base_quat)[2] < UPRIGHT:
        return "tilt"
    over = np.maximum(robot.joint_pos - a1.JOINT_UPPER, a1.JOINT_LOWER - robot.joint_pos)
    if over.max() > JOINT_SLACK:
        return "joints"
    return "moving" if np.abs(robot.joint_vel).max() > MOVING else ""


def unfit_to_go_on(robot: RobotState) -> Why:
    """In every step: why its motors must only damp from now on, or ""."""
    if not finite(robot):
        return "not finite"
    x, y, z = geometry.up_in_body(robot.base_quat).tolist()
    return "tilt" if x < -LEANS or abs(y) > LEANS or z < OVERTURNED else ""
