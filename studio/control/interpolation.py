"""The way from one key pose to the next, by share of the way; and how long it takes.

Every leg does one of three things: *plant* (its foot stays where it is on the floor, the leg
follows by IK while the base moves), *step* (its foot moves through the air to a new place on the
floor), or *swing* (its joints are interpolated, the foot carries nothing).
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.stances import JOINT_SPEED
from studio.robot import kinematics
from studio.robot.pose import RobotPose

Array = NDArray[np.float64]
LegMode = Literal["plant", "step", "swing"]
Legs = tuple[LegMode, LegMode, LegMode, LegMode]

MAX_JOINT_SPEED = JOINT_SPEED["stand"] - np.radians(4.5)
"""rad/s, under the limit so that neither rounding nor the way's samples ever cross it."""
CLEARANCE = 0.04
"""m, how high a stepping foot is lifted."""


def trapezoid(s: float) -> float:
    """For s in [0, 1]: speeds up over the first fifth, slows down over the last.

    Its fastest is 1.25 times the mean, minimum jerk's 1.875.
    """
    s = min(max(s, 0.0), 1.0)
    if s > 0.5:
        return 1.0 - trapezoid(1.0 - s)
    return 3.125 * s * s if s < 0.2 else 1.25 * s - 0.125


def trapezoid_time(u: float) -> float:
    """The share of the time at which `trapezoid` is at u."""
    if u > 0.5:
        return 1.0 - trapezoid_time(1.0 - u)
    return math.sqrt(u / 3.125) if u < 0.125 else (u + 0.125) / 1.25


@dataclass(frozen=True, kw_only=True)
class PoseInterpolation:
    """From one key pose to the next; `legs`: what each leg does; feet: (4, 3) m, world, of both."""

    start: RobotPose
    end: RobotPose
    legs: Legs
    feet: tuple[Array, Array]

    @cached_property
    def contact(self) -> Array:
        """(4,) which feet carry on the way."""
        return np.array([mode == "plant" for mode in self.legs], dtype=np.float64)

    @cached_property
    def by_foot(self) -> NDArray[np.bool_]:
        """(12,) the joints that follow their foot; the others are interpolated."""
        return np.repeat([mode != "swing" for mode in self.legs], 3)

    @cached_property
    def _turn(self) -> tuple[float, Array, Array, tuple[Array, Array, Array]]:
        """The trunk's turn: half its angle, the quaternions that cos and sin of it weigh, and the
        matrices of Rodrigues' formula: R(u) = K0 + cos(u angle) K1 + sin(u angle) K2."""
        first = self.start.base_quat.tolist()
        x, y, z = scalars.rotvec(scalars.mul(scalars.conj(first), self.end.base_quat.tolist()))
        angle = math.sqrt(x * x + y * y + z * z)
        if angle > 1e-12:
            x, y, z = x / angle, y / angle, z / angle
        across = np.array(scalars.mul(first, (0.0, x, y, z)))
        along = np.array([[x * x, x * y, x * z], [x * y, y * y, y * z], [x * z, y * z, z * z]])
        skew = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
        r = scalars.matrix(first)
        return 0.5 * angle, self.start.base_quat, across, (r @ along, r - r @ along, r @ skew)

    def quat(self, u: Array) -> Array:
        """(N, 4) orientations of the base at shares u (N,) of the way: the short way round."""
        half, start, across, _ = self._turn
        h = half * u[:, None]
        return np.cos(h) * start + np.sin(h) * across

    def rotation(self, u: Array) -> Array:
        """(N, 3, 3) the same as matrices."""
        half, _, _, (k0, k1, k2) = self._turn
        angle = 2.0 * half * u[:, None, None]
        return k0 + np.cos(angle) * k1 + np.sin(angle) * k2

    def base_pos(self, u: Array) -> Array:
        """(N, 3) m, world."""
        return self.start.base_pos + u[:, None] * (self.end.base_pos - self.start.base_pos)

    def interpolated(self, u: Array) -> Array:
        """(N, 12) rad: joints straight from start to end."""
        return self.start.joint_pos + u[:, None] * (self.end.joint_pos - self.start.joint_pos)

    def feet_b(self, u: Array) -> Array:
        """(N, 4, 3) m: where the feet are in the base frame."""
        start = self.feet[0] - self.start.base_pos
        end = self.feet[1] - self.end.base_pos
        arm = start + u[:, None, None] * (end - start)
        step = [CLEARANCE * (mode == "step") for mode in self.legs]
        arm[..., 2] += np.outer(4.0 * u * (1.0 - u), step)
        return arm @ self.rotation(u)

    def motion(self, u: Array) -> tuple[Array, Array, Array]:
        """Base (N, 3), (N, 4) and joints (N, 12) at shares u (N,) of the way."""
        joint_pos = self.interpolated(u)
        if self.by_foot.any():
            joint_pos = np.where(self.by_foot, kinematics.leg_ik(self.feet_b(u))[0], joint_pos)
        return self.base_pos(u), self.quat(u), joint_pos


@dataclass(frozen=True, kw_only=True)
class RearLegPivot(PoseInterpolation):
    """Between leaning and sitting: the trunk turns on the rear legs, whose calves lie on the floor.

    The thighs stay leaned back until the trunk is nearly up (cubic in its turn): else the centre
    of mass passes in front of the rear feet. `legs` are to be all "swing".
    """

    rising: bool

    @cached_property
    def contact(self) -> Array:
        """The rear feet carry."""
        return np.array([0.0, 0.0, 1.0, 1.0])

    @cached_property
    def _lag(self) -> float:
        low, high = (self.start, self.end) if self.rising else (self.end, self.start)
        return _thigh(high) - _thigh(low)

    def interpolated(self, u: Array) -> Array:
        """(N, 12) rad: pitch + thigh + calf stays -90 degrees; what the thigh lags, the calf
        takes up."""
        joint_pos = super().interpolated(u)
        w = u if self.rising else 1.0 - u
        lag = self._lag * (w - w**3)
        joint_pos[:, [7, 10]] -= lag[:, None]
        joint_pos[:, [8, 11]] += lag[:, None]
        return joint_pos

    def motion(self, u: Array) -> tuple[Array, Array, Array]:
        """Base (N, 3), (N, 4) and joints (N, 12) at shares u (N,) of the way."""
        joint_pos = self.interpolated(u)
        rear = kinematics.foot_pos_b(joint_pos)[:, 2:].mean(axis=1)
        start, end = (feet[2:].mean(axis=0) for feet in self.feet)
        on = start + u[:, None] * (end - start)
        return on - (self.rotation(u) @ rear[..., None])[..., 0], self.quat(u), joint_pos


def _thigh(pose: RobotPose) -> float:
    """Angle of the rear thighs against the vertical, rad; > 0: the knee behind the hip."""
    nose = scalars.row_z(pose.base_quat.tolist())[0]
    thighs = pose.joint_pos[[7, 10]].tolist()
    return 0.5 * sum(thighs) - math.asin(min(max(nose, -1.0), 1.0))


_SHARES = minimum_jerk(np.linspace(0.0, 1.0, 25))
_GAPS = np.stack([np.full(24, 1.0 / 24.0), np.diff([trapezoid_time(u) for u in _SHARES.tolist()])])[
    ..., None
]
"""Shares of the way, and of the time between them (2, 24, 1): by minimum jerk, and hurried."""


def least_seconds(ways: Sequence[PoseInterpolation]) -> Array:
    """(W, 2) s that each way takes its fastest joint at MAX_JOINT_SPEED: by minimum jerk, and
    hurried (by `trapezoid`, a third sooner).

    All of them in one go: one batch of IK costs little more than one pose.
    """
    joints = np.stack([way.interpolated(_SHARES) for way in ways])
    followed = [i for i, way in enumerate(ways) if way.by_foot.any()]
    if followed:
        feet_b = np.stack([ways[i].feet_b(_SHARES) for i in followed])
        by_foot = np.stack([ways[i].by_foot for i in followed])[:, None]
        joints[followed] = np.where(by_foot, kinematics.leg_ik(feet_b)[0], joints[followed])
    turned = np.abs(np.diff(joints, axis=1))[:, None]
    return np.max(turned / _GAPS, axis=(2, 3)) / MAX_JOINT_SPEED
