"""ReferenceMotion: poses, velocities and contacts the robot should track, at the control rate."""

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.reference.intent import StateName
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class ReferenceMotion:
    """A reference over T control periods.

    base_pos: (T, 3) m, world. base_quat: (T, 4) wxyz. joint_pos: (T, 12) rad.
    foot_contact: (T, 4) in [0, 1]. params: what the task drew (speed, clearance …), for tables.
    """

    state: StateName
    task: str
    dt: float
    base_pos: Array
    base_quat: Array
    joint_pos: Array
    foot_contact: Array
    params: dict[str, float] = field(default_factory=dict)

    def __len__(self) -> int:
        return len(self.joint_pos)

    @classmethod
    def of(cls, state: StateName, task: str, poses: Sequence[ReferencePose]) -> "ReferenceMotion":
        """The poses of consecutive control periods, one at least; velocities follow anew."""
        return cls(
            state=state,
            task=task,
            dt=CONTROL_DT,
            base_pos=np.stack([pose.base_pos for pose in poses]),
            base_quat=np.stack([pose.base_quat for pose in poses]),
            joint_pos=np.stack([pose.joint_pos for pose in poses]),
            foot_contact=np.stack([pose.foot_contact for pose in poses]),
        )

    @property
    def joint_vel(self) -> Array:
        """(T, 12) rad/s, backward differences; the first row repeats the second."""
        return backward_difference(self.joint_pos, self.dt)

    @property
    def base_lin_vel_w(self) -> Array:
        """(T, 3) m/s, world, backward differences."""
        return backward_difference(self.base_pos, self.dt)

    @property
    def base_ang_vel_b(self) -> Array:
        """(T, 3) rad/s, body, backward differences."""
        return geometry.ang_vel_b(self.base_quat, self.dt)

    def poses(self) -> list[ReferencePose]:
        """One ReferencePose per frame."""
        lin, ang, vel = self.base_lin_vel_w, self.base_ang_vel_b, self.joint_vel
        return [
            ReferencePose(
                base_pos=self.base_pos[i],
                base_quat=self.base_quat[i],
                joint_pos=self.joint_pos[i],
                foot_contact=self.foot_contact[i],
                base_lin_vel_w=lin[i],
                base_ang_vel_b=ang[i],
                joint_vel=vel[i],
            )
            for i in range(len(self))
        ]


def backward_difference(x: Array, dt: float) -> Array:
    """Rates of change (T, ...), per second, of x (T, ...), a row every dt s.

    By backward differences; the first row repeats the second.
    """
    out = np.zeros_like(x)
    if len(x) > 1:
        out[1:] = np.diff(x, axis=0) / dt
        out[0] = out[1]
    return out


def with_velocity(pose: RobotPose, previous: RobotPose, dt: float = CONTROL_DT) -> ReferencePose:
    """The pose as a reference, its velocities by backward differences from `previous`."""
    turned = scalars.mul(scalars.conj(previous.base_quat.tolist()), pose.base_quat.tolist())
    return ReferencePose(
        base_pos=pose.base_pos,
        base_quat=pose.base_quat,
        joint_pos=pose.joint_pos,
        foot_contact=pose.foot_contact,
        base_lin_vel_w=(pose.base_pos - previous.base_pos) / dt,
        base_ang_vel_b=np.array(scalars.rotvec(turned)) / dt,
        joint_vel=(pose.joint_pos - previous.joint_pos) / dt,
    )
