"""One robot's frames must be the rows that training sees of the same robot."""

import numpy as np
import pytest

from studio import geometry
from studio.control import observation_frame as frames
from studio.geometry import scalars
from studio.reference.intent import STATES
from studio.robot.pose import ReferencePose, RobotState

RNG = np.random.default_rng(5)


def draw(n: int) -> tuple[np.ndarray, ...]:
    return RNG.normal(size=(n, 12)), geometry.normalize(RNG.normal(size=(n, 4)))


@pytest.mark.parametrize("state", STATES)
@pytest.mark.parametrize("yaw_rate", [True, False])
def test_sensor_frame_is_the_batch_row(state: str, yaw_rate: bool) -> None:
    level = np.array(frames.level_quat(state))  # type: ignore[arg-type]
    joints, quats = draw(200)
    gyro = RNG.normal(size=(200, 3))
    batch = frames.sensor_frame(joints, quats, gyro, level, yaw_rate)
    for i in range(200):
        robot = RobotState(
            base_pos=np.zeros(3),
            base_quat=quats[i],
            joint_pos=joints[i],
            foot_contact=np.zeros(4),
            t=0.0,
            base_lin_vel_w=np.zeros(3),
            base_ang_vel_b=gyro[i],
            joint_vel=np.zeros(12),
            foot_pos_w=np.zeros((4, 3)),
            torque=np.zeros(12),
        )
        one = frames.one_sensor_frame(robot, scalars.rows(level.tolist()), yaw_rate)
        np.testing.assert_allclose(one, batch[i], atol=1e-12)


@pytest.mark.parametrize("state", STATES)
def test_reference_frame_is_the_batch_row(state: str) -> None:
    level = np.array(frames.level_quat(state))  # type: ignore[arg-type]
    joints, quats = draw(200)
    pos, vel, turn = RNG.normal(size=(3, 200, 3))
    batch = frames.reference_frame(joints, pos[:, 2], quats, vel, turn, level)
    for i in range(200):
        reference = ReferencePose(
            base_pos=pos[i],
            base_quat=quats[i],
            joint_pos=joints[i],
            foot_contact=np.zeros(4),
            base_lin_vel_w=vel[i],
            base_ang_vel_b=turn[i],
        )
        one = frames.one_reference_frame(reference, scalars.rows(level.tolist()))
        np.testing.assert_allclose(one, batch[i], atol=1e-12)
