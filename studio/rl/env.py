"""The vectorised environment: actions (N, 12) → observations, rewards, ends, over sim.batch."""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.control.action import clip_action, pd_target
from studio.control.observation import History
from studio.control.observation_frame import sensor_frame
from studio.reference.stances import NEUTRAL
from studio.rl.bank import MotionBank
from studio.rl.curriculum import Curriculum, stages
from studio.rl.env_config import EnvConfig
from studio.rl.noise import ReferenceNoise
from studio.rl.robots import EVERYONE, Robots, TrackingRobots
from studio.robot import a1, kinematics
from studio.sim import randomize
from studio.sim.actuation import LowPass, limit_target

Array = NDArray[np.float64]


class ImitationEnv(TrackingRobots):
    """N robots that track references of one bank; one thread only.

    After `step`, `metrics` holds this step's per-robot figures.
    """

    def __init__(
        self,
        config: EnvConfig,
        bank: MotionBank,
        seed: int = 0,
        curriculum: Curriculum | None = None,
    ) -> None:
        n = config.num_envs
        self.rng = np.random.default_rng(seed)
        super().__init__(config, bank, int(self.rng.integers(2**31)))
        self.curriculum = curriculum or Curriculum(ladder=stages(bank.tasks))
        self.neutral = NEUTRAL[bank.state].joint_pos
        self.history = History(n, config.observation)
        self.noise = ReferenceNoise(n, config.noise, self.rng)
        self.lowpass = LowPass(config.action.cutoff_hz)
        self.lowpass.reset(np.zeros((n, 12)))
        self.begin = np.zeros(n, dtype=np.intp)
        self.tracked = np.zeros(n)
        self.bias = np.zeros((n, 14))
        self._noisy = np.zeros((n, 18))
        self._choices = bank.choices(self.curriculum.stage)

    # ── one step ────────────────────────────────────────────────────────────────────────────

    def reset(self) -> NDArray[np.float32]:
        """Every robot at a random frame of a random motion; observations (N, dim)."""
        self._reset(np.arange(self.num_envs))
        return self.observation()

    def restart(self) -> None:
        """Begin everything anew under the curriculum as it stands now (after a resume)."""
        self.follow_curriculum()
        self.reset()

    def follow_curriculum(self) -> None:
        """Draw from the curriculum's present stage from the next episodes on."""
        self._choices = self.bank.choices(self.curriculum.stage)

    def step(
        self, action: Array, target: Array | None = None
    ) -> tuple[NDArray[np.float32], Array, NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """Observations, rewards (N,), terminated (N,), truncated (N,), extras.

        Robots that ended are already begun anew in the observations; extras["ended_observation"]
        keeps what those of extras["ended_ids"] saw last. Of the truncated ones alone, whose return
        goes on, extras["final_observation"] and extras["final_ids"] say it again, for
        bootstrapping, and extras["final_privileged"] what their critic saw. target: (N, 12) rad PD
        targets to use instead of the action's (the baselines of a table).
        """
        action = clip_action(np.asarray(action, dtype=np.float64))
        if target is None:
            target = pd_target(action, self._noisy[:, :12], self.neutral, self.config.action)
        self.history.push_action(action)
        target = limit_target(self.lowpass.step(target), self.world.target)
        self._push()
        self.world.step(target)
        self._advance_anchor()
        rewards = self._measure()
        terminated = self._ended()
        self.tracked += self.metrics["tracked"] * ~terminated
        self.frame += 1
        truncated = (self.frame >= self.bank.frames) & ~terminated
        self.frame = np.minimum(self.frame, self.bank.frames - 1)
        self._sense()
        extras: dict[str, Any] = {}
        done = np.flatnonzero(terminated | truncated)
        late = truncated[done]
        if len(done):
            extras["ended_ids"], extras["ended_observation"] = done, self.observation(done)
        if late.any():
            extras["final_ids"] = done[late]
            extras["final_observation"] = extras["ended_observation"][late]
            extras["final_privileged"] = self.privileged(done[late])
        if len(done) and not self.config.evaluation:
            extras["episode_tracked_ratio"] = self.tracked[done] / np.maximum(
                self.bank.frames - self.begin[done], 1
            )
            extras["stage_changed"] = self.curriculum.record(extras["episode_tracked_ratio"])
            if extras["stage_changed"]:
                self.follow_curriculum()
            self._reset(done)
        return self.observation(), rewards, terminated, truncated, extras

    def observation(self, ids: Robots = EVERYONE) -> NDArray[np.float32]:
        """(N, dim): what the policy sees now; or (n, dim), what those of `ids` see."""
        future = None
        if self.config.observation.future:
            frame, motion = self.frame[ids, None], self.motion[ids, None]
            ahead = np.minimum(
                frame + np.array(self.config.observation.future), self.bank.frames - 1
            )
            future = self.bank.feature[motion, ahead].reshape(len(frame), -1)
        return self.history.observation(future, ids)

    @property
    def noisy_joint_pos(self) -> Array:
        """(N, 12) rad, the reference's joints as the policy sees them now."""
        return self._noisy[:, :12]

    # ── inside ──────────────────────────────────────────────────────────────────────────────

    def _reset(self, ids: NDArray[np.intp]) -> None:
        n, bank, rng = len(ids), self.bank, self.rng
        stage = self.curriculum.stage
        self.motion[ids] = self._draw_motions(n)
        self.begin[ids] = self._draw_frames(n)
        drawn = randomize.draw(rng, n, self.world.num_links, stage.randomisation)
        if self.config.steep and not self.config.evaluation:
            drawn = randomize.steepened(drawn, rng, self.config.steep, stage.randomisation)
        if self.config.motors:
            drawn = randomize.with_motors(drawn, rng, stage.randomisation)
        self.world.set_dynamics(ids, drawn)
        m, f = self.motion[ids], self.begin[ids]
        qpos = np.concatenate([bank.base_pos[m, f], bank.base_quat[m, f], bank.joint_pos[m, f]], 1)
        qpos[:, 7:] += self.config.init_joint_noise * rng.standard_normal((n, 12))
        qpos[:, 7:] = np.clip(qpos[:, 7:], a1.JOINT_LOWER, a1.JOINT_UPPER)
        # A perturbed leg must not start inside the floor: lift the trunk by what it sinks in.
        feet = kinematics.foot_pos_w(qpos[:, :3], qpos[:, 3:7], qpos[:, 7:])
        qpos[:, 2] += np.maximum(a1.FOOT_RADIUS - feet[..., 2].min(axis=-1), 0.0)
        qvel = np.concatenate(
            [bank.lin_vel_w[m, f], bank.ang_vel_b[m, f], bank.joint_vel[m, f]], axis=1
        )
        if not self.config.evaluation:
            qvel[:, :6] += self._unrest(n)
        self.world.reset(ids, qpos, qvel, bank.joint_pos[m, f])
        self._reset_lowpass(ids, bank.joint_pos[m, f])
        self.frame[ids] = f + 1
        self.anchor_pos[ids] = qpos[:, :2]
        self.anchor_yaw[ids] = bank.yaw[m, f]
        self.tracked[ids] = 0.0
        self.last_vel[ids] = qvel[:, 6:]
        k = self.config.noise
        sigma = np.concatenate([np.full(12, k.encoder_bias), np.full(2, k.imu_bias)])
        self.bias[ids] = stage.randomisation * sigma * rng.standard_normal((n, 14))
        clean = bank.feature[m, self.frame[ids]]
        self._noisy[ids] = self.noise.reset(ids, clean, self.config.noise_scale)
        if bank.seen is not None:
            self._noisy[ids] = bank.seen[m, self.frame[ids]]
        self.history.reset(ids, self._sensors(ids), self._noisy[ids])
        if not self.config.evaluation:
            self._lead_astray(ids)

    def _unrest(self, n: int) -> Array:
        """(n, 6) m/s and rad/s: what some trunks still have of a motion that went before."""
        moving = (self.rng.random((n, 1)) < 0.5) * self.curriculum.stage.randomisation
        out = np.zeros((n, 6))
        out[:, :2] = self.config.init_speed * self.rng.uniform(-1.0, 1.0, (n, 2))
        out[:, 3:5] = self.config.init_spin * self.rng.uniform(-1.0, 1.0, (n, 2))
        return moving * out

    def _lead_astray(self, ids: NDArray[np.intp]) -> None:
        """The anchor to one side of the robot, and the robot's own errors with it."""
        turn = self.config.init_heading
        if turn:
            self.history.heading_error[ids] = self.rng.uniform(-turn, turn, len(ids))
            self.history.steering[ids] = self.history.heading_error[ids]
            self.anchor_yaw[ids] += self.history.heading_error[ids]

    def _reset_lowpass(self, ids: NDArray[np.intp], value: Array) -> None:
        where = np.zeros(self.num_envs, dtype=bool)
        where[ids] = True
        rest = np.zeros((self.num_envs, 12))
        rest[ids] = value
        self.lowpass.reset(rest, where)

    def _draw_motions(self, n: int) -> NDArray[np.intp]:
        if self.config.evaluation:
            return self._choices[np.arange(n) % len(self._choices)]
        return self.rng.choice(self._choices, n)

    def _draw_frames(self, n: int) -> NDArray[np.intp]:
        if self.config.evaluation:
            return np.zeros(n, dtype=np.intp)
        # Reference-state initialisation: anywhere but the last second. Some begin at the beginning:
        # a transition between states is a motion's first two seconds, and seldom met otherwise.
        first = self.rng.random(n) < self.config.init_first
        return np.where(first, 0, self.rng.integers(0, self.bank.frames - 31, n))

    def _push(self) -> None:
        scale = self.curriculum.stage.randomisation * self.config.push
        if scale <= 0.0 or self.config.evaluation:
            return
        ids = np.flatnonzero(
            self.rng.random(self.num_envs) < a1.CONTROL_DT / self.config.push_every
        )
        angle = self.rng.uniform(0.0, 2.0 * np.pi, len(ids))
        size = self.rng.uniform(0.0, scale, len(ids))
        kick = np.stack([size * np.cos(angle), size * np.sin(angle), np.zeros(len(ids))], axis=1)
        self.world.push(ids, kick)

    def _sensors(self, ids: Robots = EVERYONE) -> Array:
        """Noisy z (n, z) of robots `ids`."""
        w, k, rng = self.world, self.config.noise, self.rng
        yaw_rate = self.config.observation.yaw_rate
        scale, bias = self.curriculum.stage.randomisation, self.bias[ids]
        joints = w.joint_pos[ids] + bias[:, :12]
        joints += scale * k.encoder * rng.standard_normal(joints.shape)
        gyro = w.base_ang_vel_b[ids] + scale * k.gyro * rng.standard_normal((len(joints), 3))
        z = sensor_frame(joints, w.imu_quat[ids], gyro, self.level, yaw_rate)
        z[:, 12:14] += bias[:, 12:14]
        return z

    def _sense(self) -> None:
        bank, at = self.bank, (self.motion, self.frame)
        self._noisy = self.noise.step(bank.feature[at]) if bank.seen is None else bank.seen[at]
        self.history.push(self._sensors(), self._noisy)
