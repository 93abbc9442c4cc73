"""The robot at one instant: where it is (RobotPose) and all that is known of it (RobotState)."""

from dataclasses import dataclass, field
from typing import Annotated

import numpy as np
from numpy.typing import NDArray

from studio import geometry

Array = NDArray[np.float64]
Vector = Annotated[Array, (3,)]
Quaternion = Annotated[Array, (4,)]
PerJoint = Annotated[Array, (12,)]
PerFoot = Annotated[Array, (4,)]
FootPositions = Annotated[Array, (4, 3)]


@dataclass(frozen=True, kw_only=True)
class RobotPose:
    """Configuration of the A1 in the world.

    base_pos: (3,) m, trunk origin, world. base_quat: (4,) wxyz, T_world_base.
    joint_pos: (12,) rad, order of a1.JOINTS. foot_contact: (4,) in [0, 1], order of a1.LEGS:
    probability (reference) or 0/1 (measured).
    """

    base_pos: Vector
    base_quat: Quaternion
    joint_pos: PerJoint
    foot_contact: PerFoot

    def __post_init__(self) -> None:
        assert self.base_pos.shape == (3,)
        assert self.base_quat.shape == (4,)
        assert self.joint_pos.shape == (12,)
        assert self.foot_contact.shape == (4,)

    @property
    def yaw(self) -> float:
        """rad, the heading of the trunk, world: 0 = +x, > 0 to the left."""
        return float(geometry.heading(self.base_quat))


@dataclass(frozen=True, kw_only=True)
class ReferencePose(RobotPose):
    """A pose to be tracked, with its velocities.

    base_lin_vel_w: (3,) m/s, world. base_ang_vel_b: (3,) rad/s, body. joint_vel: (12,) rad/s.
    """

    base_lin_vel_w: Vector = field(default_factory=lambda: np.zeros(3))
    base_ang_vel_b: Vector = field(default_factory=lambda: np.zeros(3))
    joint_vel: PerJoint = field(default_factory=lambda: np.zeros(12))


@dataclass(frozen=True, kw_only=True)
class RobotState(RobotPose):
    """A pose as simulated or measured, with what the simulator knows of it.

    base_lin_vel_w: (3,) m/s, world. base_ang_vel_b: (3,) rad/s, body. joint_vel: (12,) rad/s.
    foot_pos_w: (4, 3) m, centre of each foot sphere. torque: (12,) N m, largest magnitude (signed)
    over the control period. trunk_contact: the trunk touches the ground. self_collision: two links
    of the robot touch. t: s since reset.
    """

    t: float
    base_lin_vel_w: Vector
    base_ang_vel_b: Vector
    joint_vel: PerJoint
    foot_pos_w: FootPositions
    torque: PerJoint
    trunk_contact: bool = False
    self_collision: bool = False
