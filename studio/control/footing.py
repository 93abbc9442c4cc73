"""Poses by where their feet are: which way they face, which stance fits over them, legs by IK."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.reference import stances
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL, NEUTRAL_FEET, fit_plane
from studio.robot import kinematics
from studio.robot.pose import RobotPose

Array = NDArray[np.float64]


def feet_w(pose: RobotPose) -> Array:
    """(4, 3) m, foot centres of a pose in its own world."""
    return kinematics.foot_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos)


def solve(base_pos: Array, base_quat: Array, feet: Array) -> RobotPose:
    """The pose with the base at (3,) m and (4,) wxyz and the feet at (4, 3) m, all in the world."""
    feet_b = (feet - base_pos) @ scalars.matrix(base_quat.tolist())
    return RobotPose(
        base_pos=base_pos,
        base_quat=base_quat,
        joint_pos=kinematics.leg_ik(feet_b)[0],
        foot_contact=np.ones(4),
    )


def turn_z(yaw: float) -> Array:
    """(4,) the rotation by yaw rad about the world's z axis."""
    return np.array(scalars.yaw(yaw))


def placed(pose: RobotPose, position: Array, yaw: float) -> RobotPose:
    """The pose turned by yaw about the world's z axis, then moved by position (2,)."""
    (x, y, z), turn = pose.base_pos.tolist(), scalars.yaw(yaw)
    ahead, left = scalars.turn_xy(x, y, yaw)
    return replace(
        pose,
        base_pos=np.array([ahead + position[0], left + position[1], z]),
        base_quat=np.array(scalars.mul(turn, pose.base_quat.tolist())),
    )


def over_feet(feet: Array, state: StateName) -> RobotPose:
    """The neutral pose of `state` where it fits feet at (4, 3) m in the world best."""
    position, yaw = fit_plane(NEUTRAL_FEET[state][:, :2], feet[:, :2])
    return placed(NEUTRAL[state], position, yaw)


def facing(pose: RobotPose, state: StateName) -> float:
    """The way (rad) the feet of a pose face, whatever the trunk on them does."""
    return stances.facing(state, feet_w(pose), pose.foot_contact)


def still(pose: RobotPose) -> RobotPose:
    """A reference's pose without its velocities."""
    return RobotPose(
        base_pos=pose.base_pos,
        base_quat=pose.base_quat,
        joint_pos=pose.joint_pos,
        foot_contact=pose.foot_contact,
    )


def between(held: RobotPose, target: RobotPose, w: float) -> RobotPose:
    """From one pose (w=0) to another (w=1) by base and feet: feet planted in both stay planted."""
    quat = geometry.quat_slerp(held.base_quat, target.base_quat, np.float64(w))
    base_pos = (1.0 - w) * held.base_pos + w * target.base_pos
    feet = (1.0 - w) * feet_w(held) + w * feet_w(target)
    return replace(solve(base_pos, quat, feet), foot_contact=target.foot_contact)
