"""Feet in the air straight down to the floor while the base comes to rest."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.footing import feet_w, solve, turn_z
from studio.control.interpolation import minimum_jerk
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

PUT_DOWN_PERIODS = 4
"""Control periods in which feet in the air reach the floor: 133 ms, under the 150 ms allowed."""
IN_THE_AIR = a1.FOOT_RADIUS + 0.008
"""m, height of a foot's centre from which it counts as lifted."""


class PutDown:
    """Remembers how far it has come. lin_vel_w (3,) m/s and yaw_rate rad/s: of the base before."""

    def __init__(self, start: RobotPose, lin_vel_w: Array, yaw_rate: float) -> None:
        self._start, self._feet = start, feet_w(start)
        self._vel, self._yaw_rate = lin_vel_w, yaw_rate
        self._count = 0

    @classmethod
    def begin(cls, start: RobotPose, reference: ReferencePose) -> "PutDown":
        """From a pose and the reference that had its velocities."""
        rate_w = geometry.quat_rotate(reference.base_quat, reference.base_ang_vel_b)
        return cls(start, reference.base_lin_vel_w * np.array([1.0, 1.0, 0.0]), float(rate_w[2]))

    @property
    def done(self) -> bool:
        """All feet are on the floor and the base rests."""
        return self._count >= PUT_DOWN_PERIODS

    def step(self) -> RobotPose:
        """The pose of the next control period."""
        self._count += 1
        s = self._count / PUT_DOWN_PERIODS
        # Speed falls linearly to zero: the way covered is s - s^2 / 2 of speed times duration.
        covered = (s - 0.5 * s * s) * PUT_DOWN_PERIODS * a1.CONTROL_DT
        base_pos = self._start.base_pos + covered * self._vel
        quat = geometry.quat_mul(turn_z(covered * self._yaw_rate), self._start.base_quat)
        feet = self._feet.copy()
        feet[:, 2] += (a1.FOOT_RADIUS - feet[:, 2]) * minimum_jerk(s)
        lifted = self._feet[:, 2] > IN_THE_AIR
        feet[lifted, :2] += covered * self._vel[:2]  # a swing foot lands ahead, not behind
        contact = np.where(lifted & (s < 1.0), 0.0, 1.0)
        return replace(solve(base_pos, quat, feet), foot_contact=contact)
