"""The neutral pose of each state, and tilts about it: the frame in which a state's motion is told.

A tilt is roll, pitch and yaw in the world's heading frame, on the left of the neutral orientation:
q = quat_from_rpy(tilt) * q_neutral. Standing it is the usual roll, pitch and yaw; sitting, with the
trunk near vertical, it stays regular where Euler angles and headings of the trunk itself do not
(rolling 7 degrees to the side turns the sitting trunk's own heading by 20).
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.reference.intent import StateName
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose
from studio.timing import PAPER_JOINT_SPEED_DEG

Array = NDArray[np.float64]

JOINT_SPEED: dict[StateName, float] = {
    "stand": math.radians(PAPER_JOINT_SPEED_DEG),
    "walk": math.radians(900.0),
    "sit": math.radians(PAPER_JOINT_SPEED_DEG),
}
"""rad/s a reference's joints may reach: the paper's, but for walking. A trot reaches 330 to
830 degrees a second; at 120 its feet err by 5 to 13 cm."""


def quickness(state: StateName, joint_speed: float) -> float:
    """Times JOINT_SPEED that a reference's joints may reach where a person asks for `joint_speed`,
    rad/s: standing and sitting; a trot keeps its own."""
    return 1.0 if state == "walk" else joint_speed / JOINT_SPEED[state]


SIT_PITCH = np.radians(-70.0)
"""Pitch of the sitting trunk, nose up."""
SIT_REAR = np.array([0.0, 1.15, -1.499])
"""Hip, thigh and calf of a sitting rear leg: pitch + thigh + calf = -90 degrees, the calf flat on
the floor, and the centre of mass 5 cm before the knee and 15 cm behind the foot. The further before
the knee, the more its joint must hold: at 1.30 rad a PD of 80 N m/rad gave way by 10 degrees."""
SIT_PAW_REST = np.array([0.0, 1.20, -1.10])
"""A sitting front leg at rest: the paw hangs low before the trunk (reach 0)."""
SIT_PAW_UP = np.array([0.0, -0.94, -1.45])
"""A sitting front leg as high as it goes, the paw above 0.8 m (reach 1)."""


def _sole_on_floor(quat: Array, joint_pos: Array) -> Array:
    """(3,) base position over x = y = 0 at which the lowest sole touches z = 0."""
    feet = kinematics.foot_pos_w(np.zeros(3), quat, joint_pos)
    return np.array([0.0, 0.0, a1.FOOT_RADIUS - np.min(feet[:, 2])])


def _neutral() -> dict[StateName, RobotPose]:
    level = geometry.IDENTITY_QUAT.copy()
    sit_quat = geometry.quat_from_rpy([0.0, SIT_PITCH, 0.0])
    sit_joints = np.concatenate([SIT_PAW_REST, SIT_PAW_REST, SIT_REAR, SIT_REAR])
    poses = {}
    for state, quat, joints, contact in (
        ("stand", level, a1.STAND_JOINT_POS, np.ones(4)),
        ("walk", level, a1.STAND_JOINT_POS, np.ones(4)),
        ("sit", sit_quat, sit_joints, np.array([0.0, 0.0, 1.0, 1.0])),
    ):
        poses[state] = RobotPose(
            base_pos=_sole_on_floor(quat, joints),
            base_quat=quat,
            joint_pos=np.array(joints, dtype=np.float64),
            foot_contact=contact,
        )
    return poses


NEUTRAL: dict[StateName, RobotPose] = _neutral()
"""Neutral stand, walk and sit: base at x = y = 0, heading 0, sole on the floor."""

NEUTRAL_FEET: dict[StateName, Array] = {
    state: kinematics.foot_pos_w(p.base_pos, p.base_quat, p.joint_pos)
    for state, p in NEUTRAL.items()
}
"""(4, 3) m, world: centre of each foot in the neutral pose."""


def facing(state: StateName, feet: Array, contact: Array) -> float:
    """The way (rad) that feet (4, 3) m in the world face, whatever the trunk on them does.

    Standing, the turn that carries the neutral feet onto those in contact (4,) best; sitting, by
    the line of the rear feet.
    """
    if state == "sit":
        return rear_yaw(feet)
    legs = np.flatnonzero(contact > 0.5)
    legs = legs if len(legs) > 2 else np.arange(4)
    return fit_plane(NEUTRAL_FEET[state][legs, :2], feet[legs, :2])[1]


def rear_yaw(feet: Array) -> float:
    """Heading rad by the line of the rear feet of (4, 3): a sitting trunk is too steep to tell."""
    across = feet[3] - feet[2]
    return math.atan2(-across[0], across[1])


def fit_plane(a: Array, b: Array) -> tuple[Array, float]:
    """The translation (2,) and turn rad that carry points a (N, 2) onto b best: b = R a + p."""
    ca, cb = a.mean(axis=0), b.mean(axis=0)
    da, db = a - ca, b - cb
    yaw = math.atan2(np.sum(da[:, 0] * db[:, 1] - da[:, 1] * db[:, 0]), np.sum(da * db))
    return cb - geometry.turn_xy(ca, yaw), yaw


def tilted(state: StateName, tilt: ArrayLike) -> Array:
    """Base orientations (..., 4) of tilts (..., 3) rad (roll, pitch, yaw) about the neutral."""
    return geometry.quat_mul(geometry.quat_from_rpy(tilt), NEUTRAL[state].base_quat)


def tilt_of(state: StateName, base_quat: ArrayLike) -> Array:
    """Tilts (..., 3) rad about the neutral of base orientations (..., 4): undoes `tilted`.

    Its third component is the heading (yaw) of the robot in that state.
    """
    return geometry.quat_to_rpy(
        geometry.quat_mul(base_quat, geometry.quat_conj(NEUTRAL[state].base_quat))
    )
