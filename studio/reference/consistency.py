"""Contact and temporal consistency: feet that stand stay put, joints keep to a speed limit.

The paper pins a foot to its previous position where its contact probability exceeds 0.5; pinned
anew each frame it drifts. Here a foot locks to one anchor for as long as it stands, and the root
is carried by the feet that stand.
"""

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.reference import scalars
from studio.reference.motion import ReferenceMotion
from studio.robot import a1, kinematics

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]


@dataclass(frozen=True, kw_only=True)
class ContactConfig:
    """How feet lock.

    on, off: hysteresis on the contact probability. release: s over which a foot that lets go
    returns to where it was asked to be, and a landed foot settles on the floor. pull: share per
    frame by which the root closes in on where the standing feet say it is; the rest of its motion
    is their mean displacement, so that it never jumps when the set of standing feet changes.
    slip: m; a locked foot that cannot be held closer than this is locked anew where it is.
    regrip: m; a locked foot that is asked to be further than this from its anchor steps there, if
    no more than one other foot is in the air: a swing that the contacts missed (infinite: never).
    hop, hop_s: clearance (m) and duration (s) of that step.
    """

    on: float = 0.5
    off: float = 0.4
    release: float = 0.1
    pull: float = 0.25
    slip: float = 0.015
    regrip: float = math.inf
    hop: float = 0.03
    hop_s: float = 0.2


class ContactLock:
    """Turns joint angles, trunk orientation and contact probabilities into a planted motion.

    Remembers anchors and the root; `reset` forgets. One thread at a time may call it.
    """

    def __init__(self, config: ContactConfig | None = None) -> None:
        self.config = config or ContactConfig()
        self.slips = 0
        self.reset(np.array([0.0, 0.0, a1.STAND_HEIGHT]))

    def reset(self, base_pos: Array) -> None:
        """Forget every anchor; the root stands at base_pos (3,) m, world."""
        self.base_pos = np.array(base_pos, dtype=np.float64)
        self.locked: Bools = np.zeros(4, dtype=bool)
        self.anchor_w = np.zeros((4, 3))
        self._offset = np.zeros((4, 3))  # from where a foot that let go was asked to be to its lock
        self._lift = np.zeros(4)  # height above the floor at which each foot locked
        self._since = np.full(4, np.inf)  # s since each foot locked or let go
        self._lag = np.zeros(4)  # m that the clip kept each foot from where it was asked to be
        self._asked_w = np.zeros((4, 3))
        self._hop_left = np.zeros(4)  # s that each foot's correcting step still takes
        self._arm_w: Array | None = None  # feet relative to the base, world axes, as asked last

    def step(
        self,
        joint_pos: Array,
        base_quat: Array,
        contact_prob: Array,
        dt: float,
        drift_vel_w: Array | None = None,
        root_speed: float = math.inf,
    ) -> Array:
        """The joint angles (12,) that keep locked feet on their anchors; moves `base_pos`.

        joint_pos (12,) rad and base_quat (4,) wxyz (world) as asked; contact_prob (4,). With no
        foot standing the root moves by drift_vel_w (3,) m/s and rests on its lowest foot. The
        root goes no faster than root_speed (m/s): a clip of the joints alone would tear locked
        feet off.
        """
        cfg = self.config
        turn = scalars.matrix(base_quat.tolist())
        arm = kinematics.foot_pos_b(joint_pos) @ turn.T
        self._hop_left = np.maximum(self._hop_left - dt, 0.0)
        want = (contact_prob > np.where(self.locked, cfg.off, cfg.on)) & (self._hop_left <= 0.0)
        # A foot that the clip keeps from where it should land has not landed yet.
        want &= self.locked | (self._lag < cfg.slip)
        if cfg.regrip < math.inf:
            want = self._regrip(want, self.base_pos + arm)
        stance = self.locked & want
        let_go = self.locked & ~want
        before = self.base_pos
        self._carry_root(arm, stance, dt, drift_vel_w)
        self._slow_root(before, root_speed * dt)

        asked = self.base_pos + arm
        landed = want & ~self.locked
        self._since = np.where(let_go, 0.0, self._since + dt)
        self._offset[let_go] = self.anchor_w[let_go] - asked[let_go]
        fade = np.maximum(1.0 - self._since / cfg.release, 0.0)
        swing = asked + fade[:, None] * self._offset
        hop = cfg.hop * np.sin(math.pi * self._hop_left / cfg.hop_s)
        swing[:, 2] = np.maximum(swing[:, 2], a1.FOOT_RADIUS + hop)

        # A foot that locks above the floor settles on it, rather than dropping in one frame.
        self.anchor_w[landed], self._since[landed], fade[landed] = swing[landed], 0.0, 1.0
        self._lift[landed] = swing[landed, 2] - a1.FOOT_RADIUS
        self.anchor_w[want, 2] = a1.FOOT_RADIUS + (fade * self._lift)[want]
        foot_w = np.where(want[:, None], self.anchor_w, swing)
        self.locked, self._arm_w = want, arm
        self._asked_w, self._lag = foot_w, np.zeros(4)
        return self._reach(foot_w, turn)

    def recheck(self, joint_pos: Array, base_quat: Array) -> bool:
        """After the joints were clipped to (12,): carry the root again; did a locked foot slip?

        A foot that cannot stay on its anchor is locked anew where it is, and counted in `slips`.
        """
        arm = kinematics.foot_pos_b(joint_pos) @ scalars.matrix(base_quat.tolist()).T
        late = self.base_pos + arm - self._asked_w
        self._lag = np.sqrt(np.einsum("ij,ij->i", late, late))
        # A foot that was to land but cannot get there in time is still in the air.
        missed = self.locked & (self._since <= 0.0) & (self._lag >= self.config.slip)
        self.locked &= ~missed
        self._since[missed] = np.inf
        if not self.locked.any():
            return False
        self.base_pos = _mean((self.anchor_w - arm)[self.locked])
        return self._settle_slips(self.base_pos + arm)

    def _regrip(self, want: Bools, asked: Array) -> Bools:
        """Contacts (4,) less the foot furthest from where it is asked to be, if it must step."""
        if (~want).sum() > 1:
            return want
        away = np.where(want & self.locked, np.hypot(*(asked - self.anchor_w)[:, :2].T), 0.0)
        worst = int(away.argmax())
        if away[worst] > self.config.regrip:
            self._hop_left[worst] = self.config.hop_s
            want = want.copy()
            want[worst] = False
        return want

    def _carry_root(self, arm: Array, stance: Bools, dt: float, drift: Array | None) -> None:
        if not stance.any():
            x, y, z = self.base_pos.tolist()
            z += (a1.FOOT_RADIUS - float(arm[:, 2].min()) - z) * self.config.pull
            vx, vy = (0.0, 0.0) if drift is None else drift[:2].tolist()
            self.base_pos = np.array([x + vx * dt, y + vy * dt, z])
            return
        if self._arm_w is not None:
            self.base_pos = self.base_pos + _mean((self._arm_w - arm)[stance])
        home = _mean((self.anchor_w - arm)[stance])
        self.base_pos = self.base_pos + self.config.pull * (home - self.base_pos)

    def _slow_root(self, before: Array, step: float) -> None:
        moved = self.base_pos - before
        way = math.sqrt(float(moved @ moved))
        if way > step:
            self.base_pos = before + moved * (step / way)

    def _reach(self, foot_w: Array, turn: Array) -> Array:
        joint_pos, error = kinematics.leg_ik((foot_w - self.base_pos) @ turn)
        if (self.locked & (error > self.config.slip)).any():
            self._settle_slips(self.base_pos + kinematics.foot_pos_b(joint_pos) @ turn.T)
        return joint_pos

    def _settle_slips(self, foot_w: Array) -> bool:
        error = np.linalg.norm(foot_w - self.anchor_w, axis=-1)
        slipped = self.locked & (error > self.config.slip)
        if slipped.any():
            self.anchor_w[slipped] = foot_w[slipped]
            self.slips += int(slipped.sum())
            return True
        return False


def limit_speed(joint_pos: Array, last: Array, speed_limit: float, dt: float) -> tuple[Array, bool]:
    """Temporal consistency: joints (12,) no further from `last` than speed_limit (rad/s) allows.

    A leg with one joint too fast is slowed as a whole: clipped joint by joint its foot would leave
    its way, through the floor at times. Second value: whether any leg was slowed.
    """
    step = speed_limit * dt
    delta = (joint_pos - last).reshape(4, 3)
    most = np.abs(delta).max(axis=1)
    if most.max() <= step + 1e-9:
        return joint_pos, False
    share = np.minimum(step / np.maximum(most, 1e-12), 1.0)
    return last + (share[:, None] * delta).ravel(), True


def limit_turn(base_quat: Array, last: Array, speed_limit: float, dt: float) -> tuple[Array, bool]:
    """An orientation (4,) no further from `last` than speed_limit (rad/s) allows; was it cut?"""
    start = last.tolist()
    vec = scalars.rotvec(scalars.mul(scalars.conj(start), base_quat.tolist()))
    angle = math.sqrt(vec[0] ** 2 + vec[1] ** 2 + vec[2] ** 2)
    step = speed_limit * dt
    if angle <= step + 1e-9:
        return base_quat, False
    share = step / angle
    part = scalars.from_rotvec([share * v for v in vec])
    return np.array(scalars.mul(start, part)), True


def _mean(rows: Array) -> Array:
    """Mean of rows (N, 3); quicker than `mean` on a handful."""
    return np.add.reduce(rows, axis=0) / len(rows)


def make_consistent(
    motion: ReferenceMotion, speed_limit: float, config: ContactConfig | None = None
) -> ReferenceMotion:
    """A whole noisy reference made consistent, frame by frame and causally, as it is live.

    The trunk's orientation is kept; its position is carried anew by the standing feet.
    """
    lock = ContactLock(config)
    lock.reset(motion.base_pos[0])
    last = motion.joint_pos[0]
    base_pos, joints = np.empty_like(motion.base_pos), np.empty_like(motion.joint_pos)
    contact = np.empty_like(motion.foot_contact)
    drift = motion.base_lin_vel_w
    for i in range(len(motion)):
        quat = motion.base_quat[i]
        asked = lock.step(motion.joint_pos[i], quat, motion.foot_contact[i], motion.dt, drift[i])
        last, clipped = limit_speed(asked, last, speed_limit, motion.dt)
        if clipped:
            lock.recheck(last, quat)
        base_pos[i], joints[i], contact[i] = lock.base_pos, last, lock.locked
    return ReferenceMotion(
        state=motion.state,
        task=motion.task,
        dt=motion.dt,
        base_pos=base_pos,
        base_quat=motion.base_quat,
        joint_pos=joints,
        foot_contact=contact,
        params=motion.params,
    )
