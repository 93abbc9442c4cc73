"""One period of an observation: z of the sensors and p̄ of the reference, for many robots or one.

z: 12 joint angles, roll, pitch, their rates and, by default, the gyro's yaw rate. p̄: 12 joint
angles, base height, roll, pitch, yaw rate, planar velocity in the reference's heading frame.
Training has thousands of robots; the control loop has one, in every period: `one_…` are the same
equations in plain floats, eight times quicker there.
"""

from collections.abc import Sequence
from functools import cache
from math import asin, atan2, hypot

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.geometry.scalars import Matrix
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]

REFERENCE_DIM = 18
"""Length of p̄."""


@cache
def level_quat(state: StateName) -> tuple[float, float, float, float]:
    """wxyz of the state's neutral trunk pitch, T_level_base.

    Tilt is measured about the neutral pose of a state: a sitting trunk is nearly vertical, where
    heading, roll and pitch of the trunk itself are singular.
    """
    from studio.reference.stances import NEUTRAL

    w, x, y, z = NEUTRAL[state].base_quat
    return float(w), float(x), float(y), float(z)


def roll_pitch(quat: Array, level: Array = geometry.IDENTITY_QUAT) -> Array:
    """(N, 2) rad, roll and pitch of the levelled trunk (N, 4) against its own world's vertical.

    With u the world's z in the levelled frame: roll = atan2(u_y, u_z), pitch = −asin u_x. level:
    (4,) T_level_base, the neutral tilt that is taken off.
    """
    up = geometry.up_in_body(quat) @ scalars.matrix(level.tolist()).T
    out = np.empty(up.shape[:-1] + (2,))
    out[..., 0] = np.arctan2(up[..., 1], up[..., 2])
    out[..., 1] = np.arcsin(np.minimum(np.maximum(-up[..., 0], -1.0), 1.0))
    return out


def heading_of(quat: Array, level: Array) -> Array:
    """(N,) rad heading of the trunk `quat` (N, 4) with the neutral tilt `level` (4,) taken off.

    The levelled x axis, seen from the trunk, is the first row of R(level); turned into the world
    and laid on the ground.
    """
    nose = scalars.row_x(level.tolist())
    q = (quat[..., 0], quat[..., 1], quat[..., 2], quat[..., 3])
    east, north = (scalars.dot(row(q), nose) for row in (scalars.row_x, scalars.row_y))
    return np.arctan2(north, east)


def sensor_frame(
    joint_pos: Array, imu_quat: Array, gyro_b: Array, level: Array, yaw_rate: bool = True
) -> Array:
    """z_t (N, 17), or the paper's (N, 16) without `yaw_rate`.

    joint_pos: (N, 12) rad. imu_quat: (N, 4), trunk in a frame whose z opposes gravity. gyro_b:
    (N, 3) rad/s, body. level: (4,) T_level_base of the state. The rates are those about the
    levelled trunk's x, y and z.
    """
    rates = gyro_b @ scalars.matrix(level.tolist()).T
    tilt = roll_pitch(imu_quat, level)
    return np.concatenate([joint_pos, tilt, rates if yaw_rate else rates[..., :2]], axis=-1)


def reference_frame(
    joint_pos: Array,
    base_height: Array,
    base_quat: Array,
    base_lin_vel_w: Array,
    base_ang_vel_b: Array,
    level: Array,
) -> Array:
    """p̄_t (N, 18) of reference poses: nothing in it needs odometry.

    joint_pos (N, 12) rad; base_height (N,) m; base_quat (N, 4) and base_lin_vel_w (N, 3) m/s in
    the world; base_ang_vel_b (N, 3) rad/s, body; level (4,) T_level_base. p̄: joints, height, roll
    and pitch, the rate about the world's z, the velocity ahead and to the left.
    """
    yaw = heading_of(base_quat, level)
    c, s = np.cos(yaw), np.sin(yaw)
    vx, vy = base_lin_vel_w[..., 0], base_lin_vel_w[..., 1]
    up = geometry.up_in_body(base_quat)
    rx, ry, rz = base_ang_vel_b[..., 0], base_ang_vel_b[..., 1], base_ang_vel_b[..., 2]
    out = np.empty(joint_pos.shape[:-1] + (REFERENCE_DIM,))
    out[..., :12] = joint_pos
    out[..., 12] = base_height
    out[..., 13:15] = roll_pitch(base_quat, level)
    # The vertical part of R(q) ω is the turning seen from above.
    out[..., 15] = up[..., 0] * rx + up[..., 1] * ry + up[..., 2] * rz
    out[..., 16] = c * vx + s * vy
    out[..., 17] = -s * vx + c * vy
    return out


def one_sensor_frame(robot: RobotState, level: Matrix, yaw_rate: bool) -> Array:
    """`sensor_frame` of one robot (17,) or (16,); level: the rows of its state's T_level_base."""
    roll, pitch = _one_tilt(scalars.row_z(robot.base_quat.tolist()), level)
    rates = scalars.rotate(level, robot.base_ang_vel_b.tolist())
    return np.array([*robot.joint_pos.tolist(), roll, pitch, *(rates if yaw_rate else rates[:2])])


def one_reference_frame(reference: ReferencePose, level: Matrix) -> Array:
    """`reference_frame` of one pose (18,); level: the rows of its state's T_level_base."""
    quat = reference.base_quat.tolist()
    turned = scalars.rows(quat)
    east, north, _ = scalars.rotate(turned, level[0])
    flat = hypot(east, north)
    cos, sin = (east / flat, north / flat) if flat > 0.0 else (1.0, 0.0)
    vx, vy, _ = reference.base_lin_vel_w.tolist()
    ux, uy, uz = up = turned[2]
    roll, pitch = _one_tilt(up, level)
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


def _one_tilt(up: Sequence[float], level: Matrix) -> tuple[float, float]:
    """Of the world's up in the body."""
    ux, uy, uz = scalars.rotate(level, up)
    return atan2(uy, uz), asin(min(max(-ux, -1.0), 1.0))
