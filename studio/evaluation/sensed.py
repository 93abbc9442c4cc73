"""The robot as cheap sensors feel it."""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.trackers import Tracker, TrackerInput
from studio.rl.noise import NoiseConfig


class Sensed(Tracker):
    """Wraps a controller: it sees the robot through sensors as cheap as those of the training.

    joint_pos: encoders with a bias of their own and noise; base_quat: a bias of the IMU in roll and
    pitch; base_ang_vel_b: a noisy gyro. One thread only.
    """

    def __init__(self, tracker: Tracker, noise: NoiseConfig, seed: int = 0) -> None:
        self.name = tracker.name
        self._tracker, self._noise = tracker, noise
        self._rng = np.random.default_rng([seed, 11])
        self._joint_bias = noise.encoder_bias * self._rng.standard_normal(12)
        tilt = noise.imu_bias * self._rng.standard_normal(2)
        self._imu_bias = geometry.quat_from_rotvec(np.append(tilt, 0.0))

    def reset(self, now: TrackerInput) -> None:
        """As the controller's."""
        self._tracker.reset(self._felt(now))

    def act(self, now: TrackerInput) -> NDArray[np.float64]:
        """As the controller's."""
        return self._tracker.act(self._felt(now))

    def _felt(self, now: TrackerInput) -> TrackerInput:
        robot, noise, rng = now.robot, self._noise, self._rng
        felt = replace(
            robot,
            joint_pos=robot.joint_pos + self._joint_bias + noise.encoder * rng.standard_normal(12),
            base_quat=geometry.quat_mul(robot.base_quat, self._imu_bias),
            base_ang_vel_b=robot.base_ang_vel_b + noise.gyro * rng.standard_normal(3),
        )
        return replace(now, robot=felt)
