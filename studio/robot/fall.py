"""When a driven robot counts as fallen."""

import math

from studio.metrics import FALLEN_TILT_DEG
from studio.robot.pose import RobotPose, RobotState


def fell(reference: RobotPose, robot: RobotState) -> bool:
    """The trunk touches the ground, or its tilt is over 60 degrees from the reference's.

    Not over the vertical: a sitting trunk is steep. In plain floats, once a control period.
    """
    if robot.trunk_contact:
        return True
    a, b = _up(reference.base_quat.tolist()), _up(robot.base_quat.tolist())
    return sum(p * q for p, q in zip(a, b, strict=True)) < math.cos(math.radians(FALLEN_TILT_DEG))


def _up(quat: list[float]) -> tuple[float, float, float]:
    """The world's up in the body's frame: the last row of the rotation matrix."""
    w, x, y, z = quat
    return 2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)
