"""N simulated robots beside the references they are to track: errors, reward, what a critic knows.

Nothing here draws a random number, nor knows of noise, episodes or curricula: that is `env`.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.control.observation_frame import heading_of, level_quat
from studio.rl import reward, termination
from studio.rl.bank import MotionBank, heading_feet
from studio.rl.env_config import EnvConfig
from studio.robot import a1
from studio.sim import randomize
from studio.sim.batch import BatchConfig, BatchWorld

Array = NDArray[np.float64]
Robots = NDArray[np.intp] | slice
"""Which of the N."""
EVERYONE = slice(None)
PRIVILEGED_DIM = 65
SELF_CHECK_EVERY = 15
"""Control periods between two looks at one robot for self-penetration: half a second."""


class TrackingRobots:
    """World and references of N robots; `motion` and `frame` say which pose of which motion each is
    to have now, the anchor where its root is to be.

    After `_measure`, `metrics` and `terms` hold this period's per-robot figures.
    """

    def __init__(self, config: EnvConfig, bank: MotionBank, seed: int) -> None:
        """seed: of the physics' own RNG (control-period jitter)."""
        n = config.num_envs
        self.config, self.bank, self.num_envs = config, bank, n
        legs = bank.leg_contact if config.leg_contact is None else config.leg_contact
        physics = BatchConfig(num_envs=n, threads=config.threads, leg_contact=legs)
        self.world = BatchWorld(physics, seed=seed)
        self.level = np.array(level_quat(bank.state))
        self.motion = np.zeros(n, dtype=np.intp)
        self.frame = np.zeros(n, dtype=np.intp)
        self.anchor_pos = np.zeros((n, 2))
        self.anchor_yaw = np.zeros(n)
        self.last_vel = np.zeros((n, 12))
        self.metrics: dict[str, Array] = {}
        self.terms: dict[str, Array] = {}
        self._turn = 0

    @property
    def yaw(self) -> Array:
        """(N,) rad heading of the levelled trunks."""
        return self.yaw_of(EVERYONE)

    def yaw_of(self, ids: Robots) -> Array:
        """(n,) rad heading of the levelled trunks of robots `ids`."""
        return heading_of(self.world.base_quat[ids], self.level)

    def privileged(self, ids: Robots = EVERYONE) -> NDArray[np.float32]:
        """(n, PRIVILEGED_DIM): what only a critic may know, of robots `ids`."""
        w, bank = self.world, self.bank
        motion, frame, yaw = self.motion[ids], self.frame[ids], self.yaw_of(ids)
        v, pos = w.base_lin_vel_w[ids], w.base_pos[ids]
        soon = np.minimum(frame + 3, bank.frames - 1)
        reference = bank.joint_pos[motion, frame]
        ahead = bank.joint_pos[motion, soon] - reference
        feature = bank.feature[motion, frame]
        later = bank.feature[motion, soon]
        gap = self.anchor_pos[ids] - pos[:, :2]
        parts = [
            geometry.turn_xy(v, -yaw),
            v[:, 2:],
            pos[:, 2:3],
            geometry.turn_xy(gap, -yaw),
            geometry.wrap_angle(self.anchor_yaw[ids] - yaw)[:, None],
            reference - w.joint_pos[ids],
            ahead,
            w.joint_vel[ids] * 0.1,
            feature[:, 12:],
            later[:, 12:],
            bank.contact[motion, soon],
            w.dynamics_factors[ids],
            w.delay[ids, None] * 60.0,
            10.0 * geometry.turn_xy(w.slope_axis[ids], -yaw),
        ]
        return np.concatenate(parts, axis=1, dtype=np.float32)

    def _advance_anchor(self) -> None:
        """Move the anchored reference by the reference's own velocity of this period."""
        rates = self.bank.feature[self.motion, self.frame][:, 15:18]
        self.anchor_yaw = self.anchor_yaw + rates[:, 0] * a1.CONTROL_DT
        move = geometry.turn_xy(rates[:, 1:], self.anchor_yaw)
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
        anchored = geometry.quat_mul(geometry.quat_from_yaw(turn), ref_quat)
        root = np.concatenate([self.anchor_pos, bank.base_pos[m, f][:, 2:]], axis=1)
        distance = self._off_support(feet, yaw)
        self.terms = {
            "pose": reward.pose(w.joint_pos, ref_joint, k.pose),
            "foot": reward.foot(feet, bank.feet[m, f], k.foot),
            "root_pos": reward.root_pos(w.base_pos, root, k.root_pos),
            "root_ori": reward.root_ori(geometry.quat_angle(anchored, quat), k.root_ori),
            "support": reward.support(distance, k.support),
            "acc": reward.acc(w.joint_vel, self.last_vel, a1.CONTROL_DT, k.acc),
        }
        self.last_vel = np.array(w.joint_vel)
        tilt = metrics.orientation_error(quat, ref_quat)
        foot_error = metrics.feet_apart(feet, bank.feet[m, f])
        v, ref = w.base_lin_vel_w, bank.feature[m, f]
        rate = geometry.quat_rotate(quat, w.base_ang_vel_b)[:, 2]
        self.metrics = {
            "joint_sq": metrics.joint_error_sq(w.joint_pos, ref_joint),
            "foot_error": foot_error,
            "tilt_error": tilt,
            "height_error": np.abs(w.base_pos[:, 2] - bank.base_pos[m, f][:, 2]),
            "velocity_error": np.linalg.norm(geometry.turn_xy(v, -yaw) - ref[:, 16:18], axis=-1),
            "yaw_rate_error": np.abs(rate - ref[:, 15]),
            "tracked": metrics.tracked(foot_error, tilt).astype(float),
        }
        leak = a1.CONTROL_DT / self.config.anchor_tau
        self.anchor_pos = self.anchor_pos + leak * (w.base_pos[:, :2] - self.anchor_pos)
        leak = a1.CONTROL_DT / self.config.anchor_yaw_tau
        self.anchor_yaw = self.anchor_yaw + leak * geometry.wrap_angle(yaw - self.anchor_yaw)
        return reward.total(self.terms, k)

    def _off_support(self, feet: Array, yaw: Array) -> Array:
        """(N,) m by which the centre of mass is outside the feet that should stand, 0 for < 3."""
        w, out = self.world, np.zeros(self.num_envs)
        stands = self.bank.contact[self.motion, self.frame] > 0.5
        ids = np.flatnonzero(stands.sum(axis=-1) >= reward.MIN_CONTACTS)
        gravity = self.world_gravity_direction()[ids]
        body = w.base_pos[ids], w.base_quat[ids], w.joint_pos[ids]
        point = reward.support_point(*body, gravity, yaw[ids])
        out[ids] = reward.outside_support(point, feet[ids, :, :2], stands[ids])
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
