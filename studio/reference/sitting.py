"""Sitting intents to poses: the trunk tilts over rear feet that stay, both front legs are arms.

A pure function of the intent, vectorised over time. The rear feet are pinned to the floor; the
trunk takes its tilt about the middle of the rear hips, at the height at which the lower rear knee
rests on the floor (rolling to a side raises the other hip and knee: three supports remain).
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference import stances
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

TILT_LIMIT = np.radians([7.5, 15.0, 3.5])
"""(3,) rad, roll, pitch, yaw about the neutral sit: the paper's 15, 30 and 7 degrees of range."""
KNEE_HEIGHT = 0.02
"""m: height of the knee joint of a calf lying on the floor (thigh capsule 0.017, sole 0.02)."""
SIDE_HIP = 0.45

_REAR_HIP = np.array([-0.1805, 0.0, 0.0])  # middle of the rear hips, base frame
_LEAN = -0.14  # m/rad: the hips move back as the trunk bends forward, and the other way round
# m/rad: rolling, the hips move to the side that goes down, 7.5 cm at 7.5 degrees. With one knee
# raised, feet and the other knee carry the robot; without the shift its centre of mass lies on the
# diagonal of that triangle, and it tips back onto both knees however well its joints are held (a PD
# reached 1.9 of 7.5 degrees; shifted forward instead it falls onto its front feet; now 7.4).
_ROLL_SIDE = 0.57
_FEET = stances.NEUTRAL_FEET["sit"][2:]
_HIP_W = (
    stances.NEUTRAL["sit"].base_pos
    + geometry.quat_rotate(stances.NEUTRAL["sit"].base_quat, _REAR_HIP)
)  # fmt: skip
_SETTLE = 0.003  # m: how softly the lower of two knees is chosen
OVER_KNEES = 0.056
"""m that the centre of mass is ahead of the knees on level floor."""
UPHILL = 0.06
"""m, the most by which the hips move uphill."""


def sit_poses(tilt: Array, reach: Array, reach_side: Array) -> tuple[Array, Array, Array]:
    """Base positions (T, 3), orientations (T, 4) and joint angles (T, 12) of sitting intents.

    tilt (T, 3) rad, clipped to TILT_LIMIT; reach and reach_side (T, 2). World frame.
    """
    tilt = np.clip(tilt, -TILT_LIMIT, TILT_LIMIT)
    quat = stances.tilted("sit", tilt)
    up = geometry.quat_rotate(quat, _REAR_HIP)
    hip = np.broadcast_to(_HIP_W, (len(tilt), 3)).copy()
    hip[:, 0] += _LEAN * tilt[:, 1]
    hip[:, 1] += _ROLL_SIDE * tilt[:, 0]
    front = arm_joints(np.clip(reach, 0.0, 1.0), np.clip(reach_side, -1.0, 1.0))
    for _ in range(4):  # the knee rises as the hip does, nearly one to one
        joints = _rear_legs(hip - up, quat, front)
        hip[:, 2] -= _lower_knee(hip - up, quat, joints) - KNEE_HEIGHT
    base = hip - up
    return base, quat, _rear_legs(base, quat, front)


def lean_uphill(joint_pos: Array, base_quat: Array, slope: Array) -> Array:
    """Sitting joints (12,) rad whose hips are uphill by what a floor that rises ahead leans back:
    on level floor the knees, which it tips over, are only 6 cm behind the centre of mass.

    base_quat (4,) wxyz, slope (2,) m that the floor rises a metre, world. Feet and knees stay on
    the floor, the trunk and the front legs keep their pose. A floor that falls ahead leaves margin
    enough; to a side, moved hips felled more than they held.
    """
    x, y, _ = geometry.quat_rotate(base_quat, np.array([0.0, 0.0, -1.0])).tolist()
    ahead = np.array([x, y]) / max(float(np.hypot(x, y)), 1e-9)  # the belly's way
    rise = float(ahead @ slope)
    if rise <= 0.0:
        return joint_pos
    feet = geometry.quat_rotate(base_quat, kinematics.foot_pos_b(joint_pos))
    com = geometry.quat_rotate(base_quat, kinematics.center_of_mass_b(joint_pos))
    knees = _knees(np.zeros((1, 3)), base_quat[None], joint_pos[None])[0]
    over = float((com - knees.mean(axis=0))[:2] @ ahead) - (com[2] - feet[2:, 2].mean()) * rise
    by = min(OVER_KNEES - over, UPHILL)
    if by <= 0.0:
        return joint_pos
    knee = _knee_over_feet(joint_pos, base_quat)
    feet[:, :2] -= by * ahead
    for _ in range(3):
        out = kinematics.leg_ik(geometry.quat_rotate_inverse(base_quat, feet), near=joint_pos)[0]
        feet[:, 2] += _knee_over_feet(out, base_quat) - knee
    out[:6] = joint_pos[:6]
    return out


def _knee_over_feet(joint_pos: Array, quat: Array) -> float:
    feet = geometry.quat_rotate(quat, kinematics.foot_pos_b(joint_pos))
    knee = _lower_knee(np.zeros((1, 3)), quat[None], joint_pos[None])[0]
    return float(knee - feet[2:, 2].mean())


def arm_joints(reach: Array, side: Array) -> Array:
    """Joint angles (T, 2, 3) rad of the front legs: from rest past pointing forward to overhead.

    reach (T, 2) in [0, 1], side (T, 2) in [-1, 1].
    """
    blend = reach[..., None]
    arm = stances.SIT_PAW_REST + (stances.SIT_PAW_UP - stances.SIT_PAW_REST) * blend
    # The trunk's x axis points up: paws before the chest swing aside about it.
    arm[..., 0] = SIDE_HIP * side * np.minimum(4.0 * reach, 1.0)
    return arm


def _rear_legs(base: Array, quat: Array, front: Array) -> Array:
    feet = np.broadcast_to(stances.NEUTRAL_FEET["sit"], (len(base), 4, 3))
    feet_b = geometry.quat_rotate_inverse(quat[:, None, :], feet - base[:, None, :])
    joints = kinematics.leg_ik(feet_b)[0]
    joints[:, :6] = front.reshape(-1, 6)
    return joints


def _knees(base: Array, quat: Array, joints: Array) -> Array:
    """(T, 2, 3) m, the rear knees."""
    a, b = joints[:, [6, 9]], joints[:, [7, 10]]
    x, z = -a1.THIGH_LENGTH * np.sin(b), -a1.THIGH_LENGTH * np.cos(b)
    y = a1.SIDE[2:] * a1.THIGH_OFFSET
    knee_b = a1.HIP_OFFSET[2:] + np.stack(
        [x, y * np.cos(a) - z * np.sin(a), y * np.sin(a) + z * np.cos(a)], axis=-1
    )
    return kinematics.to_world(base, quat, knee_b)


def _lower_knee(base: Array, quat: Array, joints: Array) -> Array:
    """Height (T,) m of the lower rear knee, smooth where they change places."""
    h = _knees(base, quat, joints)[..., 2]
    lowest = np.min(h, axis=-1)
    return lowest - _SETTLE * np.log(
        np.sum(np.exp(-(h - lowest[:, None]) / _SETTLE), axis=-1) / 2.0
    )
