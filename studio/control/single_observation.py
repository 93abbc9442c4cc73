"""One robot's observation frames in plain floats: `observation`'s for a batch, eight times quicker.

The same equations as `observation.sensor_frame` and `observation.reference_frame`, which training
uses on thousands of robots; the control loop has one, in every period.
"""

from collections.abc import Sequence
from math import asin, atan2, hypot

import numpy as np
from numpy.typing import NDArray

from studio.reference import scalars
from studio.reference.scalars import Matrix
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]


def sensor_frame(robot: RobotState, level: Matrix, yaw_rate: bool) -> Array:
    """z (17,), or (16,) without `yaw_rate`; level: the rows of its state's T_level_base."""
    roll, pitch = _tilt(scalars.rows(robot.base_quat.tolist())[2], level)
    rates = scalars.rotate(level, robot.base_ang_vel_b.tolist())
    return np.array([*robot.joint_pos.tolist(), roll, pitch, *(rates if yaw_rate else rates[:2])])


def reference_frame(reference: ReferencePose, level: Matrix) -> Array:
    """The reference's frame (18,); level: the rows of its state's T_level_base."""
    quat = reference.base_quat.tolist()
    turned = scalars.rows(quat)
    east, north, _ = scalars.rotate(turned, level[0])
    flat = hypot(east, north)
    cos, sin = (east / flat, north / flat) if flat > 0.0 else (1.0, 0.0)
    vx, vy, _ = reference.base_lin_vel_w.tolist()
    ux, uy, uz = up = turned[2]
    roll, pitch = _tilt(up, level)
    rx, ry, rz = reference.base_ang_vel_b.tolist()
    return np.array(
        [
            *reference.joint_pos.tolist(),
            float(reference.base_pos[2]),
            roll,
            pitch,
            ux * rx + uy * ry + uz * rz,
            cos * vx + sin * vy,
            cos * vy - sin * vx,
        ]
    )


def _tilt(up: Sequence[float], level: Matrix) -> tuple[float, float]:
    """Of the world's up in the body."""
    ux, uy, uz = scalars.rotate(level, up)
    return atan2(uy, uz), asin(min(max(-ux, -1.0), 1.0))
