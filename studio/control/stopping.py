"""A walking robot comes to rest in steps of its gait, ever shorter and slower; a slow one at once.

Set down at once, at 1 m/s, it tips over its feet, most of all where the ground falls away.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.footing import feet_w, solve, turn_z
from studio.geometry import turn_xy
from studio.geometry.time_scaling import minimum_jerk
from studio.rhythm import ALIKE, PeriodicExtrapolator
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

PUT_DOWN_PERIODS = 4
"""Control periods in which feet in the air reach the floor: 133 ms, under the 150 ms allowed."""
IN_THE_AIR = a1.FOOT_RADIUS + 0.008
"""m, height of a foot's centre from which it counts as lifted."""
BRAKING = 1.3
"""m/s^2, at which the base slows down on average."""
SLOW = 0.25
"""m/s: from a slower walk the feet are put down at once."""
LOOSE = 1.0
"""Share of the steps' own variance by which they may differ where nobody is in a hurry: put down at
once, some fall from 1 m/s."""
LANDING = 0.5
"""Share of its way to where it should be that a swinging foot makes in a control period."""


def in_the_air(pose: RobotPose) -> NDArray[np.bool_]:
    """(4,) which feet are lifted."""
    return feet_w(pose)[:, 2] > IN_THE_AIR


class PutDown:
    """Feet in the air go straight down to the floor while the base comes to rest.

    Remembers how far it has come. lin_vel_w (3,) m/s and yaw_rate rad/s: of the base before."""

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


class StrideMemory:
    """The feet's places under the base in the last two seconds of walking. One thread only."""

    def __init__(self) -> None:
        self._feet = PeriodicExtrapolator()

    def see(self, pose: RobotPose | None) -> None:
        """The pose of a control period of walking; None where the robot did something else."""
        if pose is None:
            self._feet.forget()
        else:
            self._feet.see(_under_base(pose))

    def halt(
        self, start: RobotPose, reference: ReferencePose, patient: bool = False
    ) -> "Halt | None":
        """A way to rest from a pose, whose velocities `reference` has; None for a robot too slow to
        need one, and where its steps have no rhythm yet. patient: any likeness will do."""
        alike = LOOSE if patient else ALIKE
        if np.hypot(*reference.base_lin_vel_w[:2]) < SLOW or self._feet.like(alike) is None:
            return None
        feet, self._feet = self._feet, PeriodicExtrapolator()
        return Halt(start, reference, feet)


class Halt:
    """Remembers how far it has come. Feet on the floor stay where they are in the world."""

    def __init__(
        self, start: RobotPose, reference: ReferencePose, feet: PeriodicExtrapolator
    ) -> None:
        self._pose, self._feet = start, feet
        self._middle = feet.middle()
        self._vel = turn_xy(reference.base_lin_vel_w[:2], -start.yaw)
        self._yaw_rate = float(
            geometry.quat_rotate(reference.base_quat, reference.base_ang_vel_b)[2]
        )
        speed = float(np.hypot(*self._vel))
        self._periods = int(np.ceil(speed / BRAKING / a1.CONTROL_DT))
        self._count = 0
        self._put_down: PutDown | None = None

    @property
    def done(self) -> bool:
        """All feet are on the floor and the base rests."""
        return self._put_down is not None and self._put_down.done

    def step(self) -> RobotPose:
        """The pose of the next control period."""
        if self._put_down is None and self._count >= self._periods:
            self._put_down = PutDown(self._pose, np.zeros(3), 0.0)
        return self._put_down.step() if self._put_down is not None else self._slow()

    def _slow(self) -> RobotPose:
        self._count += 1
        share = 1.0 - float(minimum_jerk(self._count / self._periods))
        last = self._pose
        yaw = last.yaw + share * self._yaw_rate * a1.CONTROL_DT
        way = turn_xy(share * self._vel * a1.CONTROL_DT, yaw)
        base_pos = last.base_pos + np.append(way, 0.0)
        quat = geometry.quat_mul(turn_z(yaw - last.yaw), last.base_quat)
        under = self._feet.guess()
        assert under is not None  # what repeated itself at the start goes on doing so
        under[:, :2] = self._middle[:, :2] + share * (under[:, :2] - self._middle[:, :2])
        wanted = np.column_stack([base_pos[:2] + turn_xy(under[:, :2], yaw), under[:, 2]])
        feet = feet_w(last)
        swings = wanted[:, 2] > IN_THE_AIR
        feet[swings, :2] += LANDING * (wanted[swings, :2] - feet[swings, :2])
        feet[:, 2] = np.where(swings, wanted[:, 2], a1.FOOT_RADIUS)
        contact = np.where(swings, 0.0, 1.0)
        self._pose = replace(solve(base_pos, quat, feet), foot_contact=contact)
        return self._pose


def _under_base(pose: RobotPose) -> Array:
    """(4, 3) m: feet from the base, along its heading; heights over the floor."""
    feet = feet_w(pose)
    return np.column_stack([turn_xy(feet[:, :2] - pose.base_pos[:2], -pose.yaw), feet[:, 2]])
