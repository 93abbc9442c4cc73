"""ReferenceMotion: poses, velocities and contacts the robot should track, at the control rate."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose

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
