"""A person as a worse sensor would send them: late, with frames lost and limbs mistaken; and the
robot as cheap sensors feel it."""

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.trackers import Tracker, TrackerInput
from studio.human.pose import HumanPose
from studio.human.skeleton import INDEX
from studio.mocap.source import Source
from studio.mocap.source_report import SourceReport
from studio.rl.noise import NoiseConfig


@dataclass(frozen=True, kw_only=True)
class Impairment:
    """sensor: whose noise the synthetic person has (`performer.sensor`). delay: s, each frame's
    drawn anew. drop: share of frames lost, one by one. gaps: a second, how often frames are missing
    for `gap_s` s. glitches: a second, how often a skeleton's estimator takes one leg or arm for the
    other, or throws a limb aside, for 1 to 5 frames."""

    sensor: str = "mocap"
    delay: tuple[float, float] = (0.0, 0.0)
    drop: float = 0.0
    gaps: float = 0.0
    gap_s: tuple[float, float] = (0.1, 0.4)
    glitches: float = 0.0


IMPAIRMENTS: dict[str, Impairment] = {
    "mocap": Impairment(),
    "dropped": Impairment(sensor="kinect", drop=0.03, gaps=0.1),
    "kinect": Impairment(sensor="kinect", delay=(0.010, 0.060), drop=0.01, gaps=0.03, glitches=0.1),
}
_SIDES = tuple((INDEX[f"l_{j}"], INDEX[f"r_{j}"]) for j in ("elbow", "wrist"))
_LEGS = tuple((INDEX[f"l_{j}"], INDEX[f"r_{j}"]) for j in ("knee", "ankle", "toe"))
_THROW = 0.35
"""m by which a limb is thrown aside."""


class Impaired(Source):
    """Wraps a source; the same seed impairs it the same way. One thread only."""

    def __init__(self, source: Source, impairment: Impairment, seed: int = 0) -> None:
        self.name, self.starts_live = source.name, source.starts_live
        self.duration = source.duration
        self._source, self._how = source, impairment
        self._rng = np.random.default_rng([seed, 7])
        self._underway: deque[tuple[float, HumanPose]] = deque()
        self._gap_until, self._glitch_left = -1.0, 0
        self._last_t = 0.0

    @property
    def report(self) -> SourceReport:
        """As the source's own: what it found, and what it refused."""
        return self._source.report

    def calibration_poses(self) -> list[HumanPose]:
        """As the source's: somebody calibrates in peace."""
        return self._source.calibration_poses()

    def close(self) -> None:
        """As the source's."""
        self._source.close()

    def read(self, t: float) -> HumanPose | None:
        """What has arrived by `t`; of several the newest."""
        pose = self._source.read(t)
        dt, self._last_t = t - self._last_t, t
        how, rng = self._how, self._rng
        draws = rng.random(4)
        if draws[0] < how.gaps * dt:
            self._gap_until = t + rng.uniform(*how.gap_s)
        if draws[1] < how.glitches * dt:
            self._glitch_left, self._kind = int(rng.integers(1, 6)), int(rng.integers(3))
        if pose is not None and draws[2] >= how.drop and t >= self._gap_until:
            if self._glitch_left > 0:
                pose, self._glitch_left = self._glitched(pose), self._glitch_left - 1
            self._underway.append((t + float(rng.uniform(*how.delay)), pose))
        arrived = None
        while self._underway and self._underway[0][0] <= t + 1e-9:
            arrived = self._underway.popleft()[1]
        return arrived

    def _glitched(self, pose: HumanPose) -> HumanPose:
        joints = np.array(pose.joint_pos_w)
        if self._kind == 2:
            limb = [INDEX[f"r_{j}"] for j in ("elbow", "wrist")]
            joints[limb] += _THROW * self._rng.uniform(-1.0, 1.0, 3)
        else:
            for left, right in _SIDES if self._kind else _LEGS:
                joints[[left, right]] = joints[[right, left]]
        return replace(pose, joint_pos_w=joints)


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
