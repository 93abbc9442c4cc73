"""A march in place read by rule: steps are timed and measured, and mean a speed and a turn.

speed = fastest walk at this cadence * min(1, sqrt(cadence * step height / BRISK))
turn  = YAW_GAIN * trunk's yaw, or LEAN_GAIN * its sideways lean, whichever says more
"""

import math
from collections import deque
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.skeleton import BONES
from studio.reference import gait
from studio.reference.tasks_walk import MAX_TURN
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

FOOT_UP = 0.035
"""m on the template's body: an ankle this far above the other has stepped ..."""
UP_SHARE, DOWN_SHARE = 0.4, 0.25
"""... and this share of the last step's height; it is back under this share of the step's own."""
CADENCES = (0.3, 2.3)
"""Strides a second that are believed."""
FIRST_CADENCE = 0.9
"""Strides a second until a second step tells."""
HIGHEST, BRISK = 0.45, 0.35
"""m: no step counts as higher. m/s: cadence times step height of somebody who means the fastest
walk that the cadence allows. On 150 synthetic marchers of both families 0.50 fitted best (people
differ in how high they step: the rule errs by 0.03 m/s at 0.8 strides a second, by 0.15 at 1.5);
less lets those who hardly lift their feet reach every speed too."""
YAW_GAIN, YAW_DEAD = 0.7, math.radians(5.0)
"""1/s and rad: turn for each radian of trunk yaw beyond a little, which is nobody's wish. 0.46
without a dead zone fitted best, erring by 1.9 deg/s: people twist by 1.4 to 3 rad a rad/s."""
LEAN_GAIN, LEAN_DEAD = 1.0, math.radians(7.0)
"""The same for sideways lean."""
PATIENCE = 1.6
"""Half strides without a step after which nobody marches any more."""

_L_ANKLE, _R_ANKLE = (3 * BONES.index(f"{side}_ankle") + 2 for side in "lr")
_L_SHOULDER, _R_SHOULDER, _CHEST = (
    slice(3 * BONES.index(name), 3 * BONES.index(name) + 3)
    for name in ("l_shoulder", "r_shoulder", "chest")
)


@dataclass(frozen=True, kw_only=True)
class March:
    """What is read off a person in one control period.

    cadence: strides/s, 0 when nobody marches. step: m, height of the last steps. speed: m/s.
    turn: rad/s, > 0 left. phase: of the stride, [0, 1): 0 where the left foot lifts, 0.5 the right.
    """

    cadence: float = 0.0
    step: float = 0.0
    speed: float = 0.0
    turn: float = 0.0
    phase: float = 0.0


def speed_of(cadence: float, step: float) -> float:
    """m/s meant by marching at `cadence` (strides/s) with feet `step` m above one another."""
    return _share(cadence, step) * float(gait.speed_limit(cadence))


def turn_of(yaw: float, lean: float) -> float:
    """rad/s meant by a trunk turned by `yaw` and leant sideways by `lean` rad, both > 0 left."""
    by_yaw, by_lean = YAW_GAIN * _beyond(yaw, YAW_DEAD), LEAN_GAIN * _beyond(lean, LEAN_DEAD)
    turn = by_yaw if abs(by_yaw) >= abs(by_lean) else by_lean
    return min(max(turn, -MAX_TURN), MAX_TURN)


def trunk_of(q: Array) -> tuple[float, float]:
    """(yaw, lean) of the trunk in rad, > 0 left, of the joints q (F,) in the heading frame."""
    across, chest = q[_L_SHOULDER] - q[_R_SHOULDER], q[_CHEST]
    return math.atan2(-across[0], across[1]), math.atan2(chest[1], chest[2])


def _share(cadence: float, step: float) -> float:
    return math.sqrt(min(1.0, cadence * min(step, HIGHEST) / BRISK))


def _beyond(angle: float, dead: float) -> float:
    return math.copysign(max(abs(angle) - dead, 0.0), angle)


class MarchReader:
    """Times steps and measures them; `step` once a control period. One thread."""

    def __init__(self, dt: float = CONTROL_DT) -> None:
        self._dt = dt
        self._t = 0.0
        self._up: int | None = None  # 0: the left foot is up, 1: the right one
        self._foot: int | None = None  # which stepped last
        self._at = -math.inf  # s of its step
        self._half = 0.5 / FIRST_CADENCE  # s between the last steps
        self._peak, self._step = 0.0, 0.0
        self._trunk: deque[tuple[float, float]] = deque(maxlen=round(1.0 / CADENCES[0] / dt))

    def step(self, q: Array) -> March:
        """Read one more frame: q (F,) of the person's features."""
        self._t += self._dt
        self._trunk.append(trunk_of(q))
        self._watch(float(q[_L_ANKLE] - q[_R_ANKLE]))
        if self._t - self._at > PATIENCE * self._half:
            self._step = 0.0
            return March()
        cadence, step = 0.5 / self._half, max(self._step, self._peak)
        # A march sways the trunk: what is meant is the mean over a stride.
        span = round(2.0 * self._half / self._dt)
        yaw, lean = np.mean(list(self._trunk)[-span:], axis=0).tolist()
        # The next foot is waited for: a step that takes longer holds the phase.
        phase = 0.5 * (self._foot or 0) + min(cadence * (self._t - self._at), 0.5)
        return March(
            cadence=cadence,
            step=step,
            speed=speed_of(cadence, step),
            turn=turn_of(yaw, lean),
            phase=phase % 1.0,
        )

    def _watch(self, above: float) -> None:
        """Feet: `above` m is the left ankle's height over the right one's."""
        if self._up is None:
            if abs(above) > max(FOOT_UP, UP_SHARE * self._step):
                self._up = 0 if above > 0.0 else 1
                self._stepped(self._up)
        elif abs(above) < DOWN_SHARE * self._peak or (above > 0.0) != (self._up == 0):
            self._up = None
            self._step = self._peak if self._step <= 0.0 else 0.5 * (self._step + self._peak)
            self._peak = 0.0
        if self._up is not None:
            self._peak = max(self._peak, abs(above))

    def _stepped(self, foot: int) -> None:
        """A foot left the floor: how long after the one before?"""
        gap, halves = self._t - self._at, 2 if foot == self._foot else 1
        if gap > PATIENCE * self._half * halves + 0.5:  # the first one, or after a pause
            self._half = 0.5 / FIRST_CADENCE
        else:
            slow, quick = (0.5 / c for c in CADENCES)
            half = min(max(gap / halves, quick), slow)
            self._half = 0.5 * (self._half + half)
        self._foot, self._at = foot, self._t
