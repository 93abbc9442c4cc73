"""Contact consistency: feet that stand stay put, and carry the root.

The paper pins a foot to its previous position where its contact probability exceeds 0.5; pinned
anew each frame it drifts. Here a foot locks to one anchor for as long as it stands, and the root
is carried by the feet that stand.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.geometry.scalars import Vec
from studio.robot import a1, single

Array = NDArray[np.float64]
Bools = NDArray[np.bool_]
LEGS = range(4)
_PULL_UP = 0.25  # `pull` at least, for the root's height
_ZERO_HIPS = (0.0,) * 4


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
    hop, hop_s: clearance (m) and duration (s) of that step. clearance: m; a foot that surely swings
    is at least this high, less so the surer it stands: averages of many steps scuff the floor.
    steady: s; time constant of the root's way over the floor (0: none). Feet asked for by a network
    slow down before they lift; a root that stopped with them, three times a second, went nowhere.
    """

    on: float = 0.5
    off: float = 0.4
    release: float = 0.1
    pull: float = 0.25
    slip: float = 0.015
    regrip: float = math.inf
    hop: float = 0.03
    hop_s: float = 0.2
    clearance: float = 0.0
    steady: float = 0.0


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
        # Plain lists below: on four legs floats are three times quicker than arrays.
        # From where a foot that let go was asked to be to where it was locked.
        self._offset: list[Vec] = [(0.0, 0.0, 0.0)] * 4
        self._lift = [0.0] * 4  # height above the floor at which each foot locked
        self._since = [math.inf] * 4  # s since each foot locked or let go
        self._lag = [0.0] * 4  # m that the clip kept each foot from where it was asked to be
        self._asked_w: list[Vec] = [(0.0, 0.0, 0.0)] * 4
        self._hop_left = [0.0] * 4  # s that each foot's correcting step still takes
        self._way = [0.0, 0.0]  # m of the last period's way over the floor, smoothed
        self._arm_w: list[Vec] | None = None  # feet relative to the base, world axes, as asked last

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
        turn = scalars.rows(base_quat.tolist())
        arm = [scalars.rotate(turn, foot) for foot in single.feet(joint_pos.tolist())]
        was: list[bool] = self.locked.tolist()
        anchor: list[list[float]] = self.anchor_w.tolist()
        self._hop_left = [max(left - dt, 0.0) for left in self._hop_left]
        # A foot that the clip keeps from where it should land has not landed yet.
        want = [
            prob > (cfg.off if locked else cfg.on) and left <= 0.0 and (locked or lag < cfg.slip)
            for prob, locked, left, lag in zip(
                contact_prob.tolist(), was, self._hop_left, self._lag, strict=True
            )
        ]
        prob: list[float] = contact_prob.tolist()
        before: list[float] = self.base_pos.tolist()
        if cfg.regrip < math.inf:
            self._regrip(want, was, anchor, before, arm)
        stance = [i for i in LEGS if was[i] and want[i]]
        drift = (0.0, 0.0) if drift_vel_w is None else drift_vel_w[:2].tolist()
        base = self._root_over_stance(before, arm, anchor, stance, drift, dt)
        base = scalars.no_further(base, before, root_speed * dt)

        foot_w: list[Vec] = []
        for i in LEGS:
            x, y, z = (base[0] + arm[i][0], base[1] + arm[i][1], base[2] + arm[i][2])
            self._since[i] += dt
            if was[i] and not want[i]:
                self._since[i] = 0.0
                self._offset[i] = (anchor[i][0] - x, anchor[i][1] - y, anchor[i][2] - z)
            fade = max(1.0 - self._since[i] / cfg.release, 0.0)
            dx, dy, dz = self._offset[i]
            hop = cfg.hop * math.sin(math.pi * self._hop_left[i] / cfg.hop_s)
            if cfg.clearance > 0.0:
                hop = max(hop, cfg.clearance * _swings(prob[i], cfg.off))
            foot = (x + fade * dx, y + fade * dy, max(z + fade * dz, a1.FOOT_RADIUS + hop))
            if want[i]:
                if not was[i]:
                    # A foot that locks above the floor settles on it, rather than dropping.
                    anchor[i], self._since[i], fade = list(foot), 0.0, 1.0
                    self._lift[i] = foot[2] - a1.FOOT_RADIUS
                anchor[i][2] = a1.FOOT_RADIUS + fade * self._lift[i]
                foot = (anchor[i][0], anchor[i][1], anchor[i][2])
            foot_w.append(foot)
        self.base_pos, self.locked, self.anchor_w = np.array(base), np.array(want), np.array(anchor)
        self._arm_w, self._asked_w, self._lag = arm, foot_w, [0.0] * 4
        return self._reach(foot_w, base, turn, want)

    def recheck(self, joint_pos: Array, base_quat: Array) -> bool:
        """After the joints were clipped to (12,): carry the root again; did a locked foot slip?

        A foot that cannot stay on its anchor is locked anew where it is, and counted in `slips`.
        """
        turn = scalars.rows(base_quat.tolist())
        arm = [scalars.rotate(turn, foot) for foot in single.feet(joint_pos.tolist())]
        base: list[float] = self.base_pos.tolist()
        self._lag = [
            math.dist(asked, scalars.add(base, a))
            for asked, a in zip(self._asked_w, arm, strict=True)
        ]
        for i in LEGS:
            # A foot that was to land but cannot get there in time is still in the air.
            if self.locked[i] and self._since[i] <= 0.0 and self._lag[i] >= self.config.slip:
                self.locked[i], self._since[i] = False, math.inf
        stance = [i for i in LEGS if self.locked[i]]
        if not stance:
            return False
        base = scalars.mean_gap(self.anchor_w.tolist(), arm, stance)
        self.base_pos = np.array(base)
        return self._settle_slips([scalars.add(base, a) for a in arm])

    def _regrip(
        self,
        want: list[bool],
        was: list[bool],
        anchor: list[list[float]],
        base: list[float],
        arm: list[Vec],
    ) -> None:
        """The foot furthest from where it is asked to be steps there: taken out of `want` (4,)."""
        if sum(want) < 3:
            return
        away = [
            math.hypot(base[0] + arm[i][0] - anchor[i][0], base[1] + arm[i][1] - anchor[i][1])
            if want[i] and was[i]
            else 0.0
            for i in LEGS
        ]
        furthest = max(away)
        if furthest > self.config.regrip:
            worst = away.index(furthest)
            self._hop_left[worst] = self.config.hop_s
            want[worst] = False

    def _root_over_stance(
        self,
        base: list[float],
        arm: list[Vec],
        anchor: list[list[float]],
        stance: list[int],
        drift: Sequence[float],
        dt: float,
    ) -> list[float]:
        """Where the standing feet carry the root (3,); without any, drift (2,) m/s does."""
        pull = self.config.pull
        if not stance:
            x, y, z = base
            z += (a1.FOOT_RADIUS - min(a[2] for a in arm) - z) * pull
            return [x + drift[0] * dt, y + drift[1] * dt, z]
        if self._arm_w is not None:
            step = scalars.mean_gap(self._arm_w, arm, stance)
            share = min(dt / self.config.steady, 1.0) if self.config.steady > 0.0 else 1.0
            self._way = [w + share * (s - w) for w, s in zip(self._way, step[:2], strict=True)]
            base = list(scalars.add(base, (*self._way, step[2])))
        home = scalars.mean_gap(anchor, arm, stance)
        pulls = (pull, pull, max(pull, _PULL_UP))
        return [b + p * (h - b) for b, h, p in zip(base, home, pulls, strict=True)]

    def _reach(
        self, foot_w: list[Vec], base: list[float], turn: scalars.Matrix, locked: list[bool]
    ) -> Array:
        foot_b = [
            scalars.rotate_back(turn, (x - base[0], y - base[1], z - base[2])) for x, y, z in foot_w
        ]
        joint_pos, error = single.joints(foot_b, _ZERO_HIPS)
        if any(on and off > self.config.slip for on, off in zip(locked, error, strict=True)):
            reached = single.feet(joint_pos)
            self._settle_slips([scalars.add(base, scalars.rotate(turn, foot)) for foot in reached])
        return np.array(joint_pos)

    def _settle_slips(self, foot_w: list[Vec]) -> bool:
        slipped = False
        for i in LEGS:
            if self.locked[i] and math.dist(foot_w[i], self.anchor_w[i]) > self.config.slip:
                self.anchor_w[i] = foot_w[i]
                self.slips += 1
                slipped = True
        return slipped


def _swings(prob: float, off: float) -> float:
    """How surely a foot swings: 0 at the contact probability `off`, 1 at a quarter of it."""
    s = min(max((off - prob) / (0.75 * off), 0.0), 1.0)
    return s * s * (3.0 - 2.0 * s)
