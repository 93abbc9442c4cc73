"""The vectorised environment: actions (N, 12) → observations, rewards, ends, over sim.batch."""

from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import spatial
from studio.imitation import reward, termination
from studio.imitation.action import ActionConfig, clip_action, pd_target
from studio.imitation.bank import MotionBank, heading_feet
from studio.imitation.curriculum import Curriculum, stages
from studio.imitation.noise import NoiseConfig, ReferenceNoise
from studio.imitation.observation import (
    Foresee,
    History,
    ObservationConfig,
    heading_of,
    level_quat,
    sensor_frame,
)
from studio.imitation.odometry import CONTACT_GAP, turned
from studio.imitation.reward import RewardConfig
from studio.robot import a1, kinematics
from studio.sim import randomize
from studio.sim.actuation import LowPass, limit_target
from studio.sim.batch import BatchConfig, BatchWorld

Array = NDArray[np.float64]
TRACKED_FOOT_M = 0.08
TRACKED_TILT = np.deg2rad(15.0)
PRIVILEGED_DIM = 65
EVERYONE = slice(None)
SELF_CHECK_EVERY = 15
"""Control periods between two looks at one robot for self-penetration: half a second."""


@dataclass(frozen=True, kw_only=True)
class EnvConfig:
    """One environment's settings, saved beside the weights trained in it.

    anchor_tau, anchor_yaw_tau: s, leak of the re-anchored root's place and heading. leg_contact:
    calves and thighs touch the floor, None for where the bank needs it. push: m/s, largest kick, at
    full randomisation, and push_every its mean interval in s. noise_scale: of reference noise.
    init_first: share of the episodes that begin with a motion's first frame. init_speed (m/s),
    init_spin (rad/s): of half of the trunks at the start, on top of the reference's.
    init_heading (rad), init_place (m): how far off its way a robot may begin, so that a policy that
    holds them learns to steer: its own errors are small and seldom.
    steep: share of the episodes on slopes of STEEP of Table I's largest, which an even draw seldom
    meets and a sitting robot falls on.
    evaluation: motions in order from their first frame, no kicks, and nobody begins anew: whatever
    a controller does, it meets the same references, dynamics and noise.
    """

    num_envs: int = 512
    threads: int = 0
    observation: ObservationConfig = field(default_factory=ObservationConfig)
    action: ActionConfig = field(default_factory=ActionConfig)
    reward: RewardConfig = field(default_factory=RewardConfig)
    noise: NoiseConfig = field(default_factory=NoiseConfig)
    noise_scale: float = 1.0
    anchor_tau: float = 0.5
    anchor_yaw_tau: float = 0.5
    leg_contact: bool | None = None
    push: float = 0.4
    push_every: float = 4.0
    init_joint_noise: float = 0.03
    init_first: float = 0.0
    init_speed: float = 0.0
    init_spin: float = 0.0
    init_heading: float = 0.0
    init_place: float = 0.0
    steep: float = 0.0
    evaluation: bool = False


class ImitationEnv:
    """N robots that track references of one bank; one thread only.

    After `step`, `metrics` holds this step's per-robot figures (see `_measure`).
    """

    def __init__(
        self,
        config: EnvConfig,
        bank: MotionBank,
        seed: int = 0,
        curriculum: Curriculum | None = None,
        foresee: Foresee | None = None,
    ) -> None:
        n = config.num_envs
        self.config, self.bank, self.num_envs = config, bank, n
        self.foresee = foresee
        self.rng = np.random.default_rng(seed)
        legs = bank.leg_contact if config.leg_contact is None else config.leg_contact
        self.world = BatchWorld(
            BatchConfig(num_envs=n, threads=config.threads, leg_contact=legs),
            seed=int(self.rng.integers(2**31)),
        )
        self.curriculum = curriculum or Curriculum(ladder=stages(bank.tasks))
        self.level = np.array(level_quat(bank.state))
        self.neutral = neutral_joints(bank)
        self.history = History(n, config.observation, foresee)
        self.noise = ReferenceNoise(n, config.noise, self.rng)
        self.lowpass = LowPass(config.action.cutoff_hz)
        self.lowpass.reset(np.zeros((n, 12)))
        self.motion = np.zeros(n, dtype=np.intp)
        self.frame = np.zeros(n, dtype=np.intp)
        self.begin = np.zeros(n, dtype=np.intp)
        self.anchor_pos = np.zeros((n, 2))
        self.anchor_yaw = np.zeros(n)
        self.tracked = np.zeros(n)
        self.last_vel = np.zeros((n, 12))
        self.bias = np.zeros((n, 14))
        self.metrics: dict[str, Array] = {}
        self.terms: dict[str, Array] = {}
        self._noisy = np.zeros((n, 18))
        self._choices = bank.choices(self.curriculum.stage)
        self._turn = 0

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

    def observation(self, ids: NDArray[np.intp] | slice = EVERYONE) -> NDArray[np.float32]:
        """(N, dim): what the policy sees now; or (n, dim), what those of `ids` see."""
        future = None
        if self.config.observation.future_kind == "true" and self.config.observation.future:
            frame, motion = self.frame[ids, None], self.motion[ids, None]
            ahead = np.minimum(
                frame + np.array(self.config.observation.future), self.bank.frames - 1
            )
            future = self.bank.feature[motion, ahead].reshape(len(frame), -1)
        return self.history.observation(future, ids)

    def privileged(self, ids: NDArray[np.intp] | slice = EVERYONE) -> NDArray[np.float32]:
        """(n, PRIVILEGED_DIM): what only a critic may know, of robots `ids`."""
        w, bank = self.world, self.bank
        motion, frame, yaw = self.motion[ids], self.frame[ids], self.yaw_of(ids)
        c, s = np.cos(yaw), np.sin(yaw)
        v, pos = w.base_lin_vel_w[ids], w.base_pos[ids]
        forward = np.stack([c * v[:, 0] + s * v[:, 1], -s * v[:, 0] + c * v[:, 1], v[:, 2]], -1)
        soon = np.minimum(frame + 3, bank.frames - 1)
        reference = bank.joint_pos[motion, frame]
        ahead = bank.joint_pos[motion, soon] - reference
        feature = bank.feature[motion, frame]
        later = bank.feature[motion, soon]
        gap = self.anchor_pos[ids] - pos[:, :2]
        local = np.stack([c * gap[:, 0] + s * gap[:, 1], -s * gap[:, 0] + c * gap[:, 1]], -1)
        a = w.slope_axis[ids]
        slope = np.stack([c * a[:, 0] + s * a[:, 1], -s * a[:, 0] + c * a[:, 1]], -1)
        parts = [
            forward,
            pos[:, 2:3],
            local,
            spatial.wrap_angle(self.anchor_yaw[ids] - yaw)[:, None],
            reference - w.joint_pos[ids],
            ahead,
            w.joint_vel[ids] * 0.1,
            feature[:, 12:],
            later[:, 12:],
            bank.contact[motion, soon],
            w.dynamics_factors[ids],
            w.delay[ids, None] * 60.0,
            10.0 * slope,
        ]
        return np.concatenate(parts, axis=1, dtype=np.float32)

    @property
    def noisy_joint_pos(self) -> Array:
        """(N, 12) rad, the reference's joints as the policy sees them now."""
        return self._noisy[:, :12]

    # ── inside ──────────────────────────────────────────────────────────────────────────────

    @property
    def yaw(self) -> Array:
        """(N,) rad heading of the levelled trunks."""
        return self.yaw_of(EVERYONE)

    def yaw_of(self, ids: NDArray[np.intp] | slice) -> Array:
        """(n,) rad heading of the levelled trunks of robots `ids`."""
        return heading_of(self.world.base_quat[ids], self.level)

    def _reset(self, ids: NDArray[np.intp]) -> None:
        n, bank, rng = len(ids), self.bank, self.rng
        stage = self.curriculum.stage
        self.motion[ids] = self._draw_motions(n)
        self.begin[ids] = self._draw_frames(n)
        drawn = randomize.draw(rng, n, self.world.num_links, stage.randomisation)
        if self.config.steep and not self.config.evaluation:
            drawn = randomize.steepened(drawn, rng, self.config.steep, stage.randomisation)
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
        self.history.reset(ids, self._sensors(ids), self._noisy[ids], self._foot_sensors(ids))
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
        turn, place = self.config.init_heading, self.config.init_place
        if turn:
            self.history.heading_error[ids] = self.rng.uniform(-turn, turn, len(ids))
            self.anchor_yaw[ids] += self.history.heading_error[ids]
        if place:
            angle = self.rng.uniform(0.0, 2.0 * np.pi, len(ids))
            size = self.rng.uniform(0.0, place, len(ids))
            local = size[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)
            self.history.place_error[ids] = local
            self.anchor_pos[ids] += turned(local, self.yaw_of(ids))

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
        # a crossing between states is a motion's first two seconds, and seldom met otherwise.
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

    def _sensors(self, ids: NDArray[np.intp] | slice = EVERYONE) -> Array:
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
        self.history.push(self._sensors(), self._noisy, self._foot_sensors())

    def _foot_sensors(self, ids: NDArray[np.intp] | slice = EVERYONE) -> Array:
        """(n, 4) which feet touch the ground; only read where the place is held."""
        w = self.world
        pos = w.base_pos[ids]
        if not self.config.observation.place_gain:
            return np.zeros((len(pos), 4))
        feet = kinematics.foot_pos_w(pos, w.base_quat[ids], w.joint_pos[ids])
        return (feet[..., 2] < a1.FOOT_RADIUS + CONTACT_GAP).astype(np.float64)

    def _advance_anchor(self) -> None:
        """Move the anchored reference by the reference's own velocity of this period."""
        yaw_rate, forward, left = self.bank.feature[self.motion, self.frame][:, 15:18].T
        self.anchor_yaw = self.anchor_yaw + yaw_rate * a1.CONTROL_DT
        c, s = np.cos(self.anchor_yaw), np.sin(self.anchor_yaw)
        move = np.stack([c * forward - s * left, s * forward + c * left], axis=-1)
        self.anchor_pos = self.anchor_pos + move * a1.CONTROL_DT

    def _measure(self) -> Array:
        """Terms, metrics and reward of the period that just passed, against the clean reference.

        Afterwards the anchor leaks towards the robot, because no sensor of the policy knows its
        x, y and yaw for long.
        """
        w, bank, k = self.world, self.bank, self.config.reward
        m, f = self.motion, self.frame
        yaw = self.yaw
        quat, ref_quat = w.base_quat, bank.base_quat[m, f]
        ref_joint = bank.joint_pos[m, f]
        feet = heading_feet(w.joint_pos, quat, yaw)
        turn = self.anchor_yaw - bank.yaw[m, f]
        half = np.stack([np.cos(turn / 2), 0 * turn, 0 * turn, np.sin(turn / 2)], axis=-1)
        anchored = spatial.quat_mul(half, ref_quat)
        root = np.concatenate([self.anchor_pos, bank.base_pos[m, f][:, 2:]], axis=1)
        distance = self._off_support(feet, yaw)
        self.terms = {
            "pose": reward.pose(w.joint_pos, ref_joint, k.pose),
            "foot": reward.foot(feet, bank.feet[m, f], k.foot),
            "root_pos": reward.root_pos(w.base_pos, root, k.root_pos),
            "root_ori": reward.root_ori(spatial.quat_angle(anchored, quat), k.root_ori),
            "support": reward.support(distance, k.support),
            "acc": reward.acc(w.joint_vel, self.last_vel, a1.CONTROL_DT, k.acc),
        }
        self.last_vel = np.array(w.joint_vel)
        tilt = termination.tilt_error(quat, ref_quat)
        foot_error = np.linalg.norm(feet - bank.feet[m, f], axis=-1).mean(axis=-1)
        v, ref = w.base_lin_vel_w, bank.feature[m, f]
        cy, sy = np.cos(yaw), np.sin(yaw)
        dv = np.stack([cy * v[:, 0] + sy * v[:, 1], -sy * v[:, 0] + cy * v[:, 1]], -1)
        rate = spatial.quat_rotate(quat, w.base_ang_vel_b)[:, 2]
        self.metrics = {
            "joint_sq": np.mean((w.joint_pos - ref_joint) ** 2, axis=-1),
            "foot_error": foot_error,
            "tilt_error": tilt,
            "height_error": np.abs(w.base_pos[:, 2] - bank.base_pos[m, f][:, 2]),
            "velocity_error": np.linalg.norm(dv - ref[:, 16:18], axis=-1),
            "yaw_rate_error": np.abs(rate - ref[:, 15]),
            "tracked": ((foot_error < TRACKED_FOOT_M) & (tilt < TRACKED_TILT)).astype(float),
        }
        leak = a1.CONTROL_DT / self.config.anchor_tau
        self.anchor_pos = self.anchor_pos + leak * (w.base_pos[:, :2] - self.anchor_pos)
        leak = a1.CONTROL_DT / self.config.anchor_yaw_tau
        self.anchor_yaw = self.anchor_yaw + leak * spatial.wrap_angle(yaw - self.anchor_yaw)
        return reward.total(self.terms, k)

    def _off_support(self, feet: Array, yaw: Array) -> Array:
        """(N,) m by which the centre of mass is outside the feet that should stand, 0 for < 3."""
        w, out = self.world, np.zeros(self.num_envs)
        stands = self.bank.contact[self.motion, self.frame] > 0.5
        ids = np.flatnonzero(stands.sum(axis=-1) >= reward.MIN_CONTACTS)
        gravity = self.world_gravity_direction()[ids]
        body = w.base_pos[ids], w.base_quat[ids], w.joint_pos[ids]
        point = reward.support_point(*body, gravity, yaw[ids])
        out[ids] = reward.polygon_distance(point, feet[ids, :, :2], stands[ids])
        return out

    def world_gravity_direction(self) -> Array:
        """(N, 3) unit gravity in the frame of the ground."""
        return randomize.gravity(self.world.slope_axis, 1.0)

    def _ended(self) -> NDArray[np.bool_]:
        w = self.world
        reference = self.bank.base_quat[self.motion, self.frame]
        ended = termination.fallen(w.base_pos, w.base_quat, reference)
        ended |= ~np.isfinite(w.qpos).all(axis=-1)
        # Links through links: as dear as the physics itself, so each robot is looked at in turn.
        self._turn = (self._turn + 1) % SELF_CHECK_EVERY
        some = slice(self._turn, None, SELF_CHECK_EVERY)
        if len(ended[some]):
            ended[some] |= termination.self_penetrating(w.joint_pos[some])
        return ended


def neutral_joints(bank: MotionBank) -> Array:
    """(12,) rad neutral joint angles of the bank's state."""
    from studio.reference.stances import NEUTRAL

    return NEUTRAL[bank.state].joint_pos
