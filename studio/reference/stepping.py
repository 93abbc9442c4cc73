"""A wanted velocity to walking intents: the robot's own steps, as many and as quick as it needs.

Where a march is not copied (`retarget.semantic`, travelling), only the velocity is the person's.
"""

import math

import numpy as np

from studio.reference import gait
from studio.reference.intent import Intent

SETTLE_S = 0.4
"""s, time constant of the cadence."""
LIFT = 0.8
"""Clearance of the steps, as `Intent.lift`."""
STRETCH = 0.75
"""Share of the longest steps that a cadence leaves for a speed: told 0.5 m/s, the simulated robot
walks 0.47 at 1.6 strides a second, 0.43 at 1.4 and 0.36 at 1.8."""
CRAWLS, TROTS = np.linspace(0.3, 0.9, 13), np.linspace(1.4, 2.3, 19)
"""Strides a second of the robot."""
_CRAWL_SPEEDS, _TROT_SPEEDS = gait.speed_limit(CRAWLS), gait.speed_limit(TROTS)
_TURN_SHARE = 0.9
"""Share of the largest turn of a stride that a cadence leaves for a turn."""


def forward_cadence(speed: float) -> float:
    """Strides a second for a straight walk at `speed` m/s: a crawl while it can, then a trot.

    Each at the slowest pace that has the speed within STRETCH of its longest steps: short quick
    steps scuff, and between crawl and trot the robot tips.
    """
    wanted = speed / STRETCH
    crawls = wanted <= _CRAWL_SPEEDS[-1]
    speeds, cadences = (_CRAWL_SPEEDS, CRAWLS) if crawls else (_TROT_SPEEDS, TROTS)
    return float(np.interp(wanted, speeds, cadences))


def trot_cadence(forward: float, left: float, turn: float) -> float:
    """Strides a second of the slowest trot in whose reach a velocity (m/s, rad/s) lies."""
    duty = gait.duty(1.0)
    ahead = np.maximum(gait.max_travel(TROTS) * TROTS / duty - gait.HALF_WIDTH * abs(turn), 1e-6)
    size = np.hypot(forward / ahead, left * duty / (gait.MAX_SIDESTEP * TROTS))
    enough = (size <= STRETCH) & (abs(turn) <= _TURN_SHARE * gait.MAX_YAW_TROTTING * TROTS)
    return float(TROTS[np.argmax(enough)] if enough.any() else TROTS[-1])


class Stepper:
    """Steps on while there is somewhere to go, and stops with all feet down. One thread."""

    def __init__(self, task: str) -> None:
        self._task = task
        self.phase, self.cadence = gait.REST_PHASE, 0.0

    def behind(self, phase: float) -> float:
        """Strides by which the steps are behind a phase, the shorter way round: [-0.5, 0.5)."""
        return (phase - self.phase + 0.5) % 1.0 - 0.5

    def step(
        self, dt: float, goal: float, speed: float, side: float = 0.0, turn: float = 0.0
    ) -> Intent:
        """One control period of `dt` s. goal: strides a second to go over to, 0 to stop. speed,
        side: m/s forward and to the left; turn: rad/s, > 0 left."""
        if goal > 0.0:
            share = 1.0 if self.cadence <= 0.0 else dt / SETTLE_S
            self.cadence += share * (goal - self.cadence)
            self.phase += self.cadence * dt
        else:
            halves = math.ceil(2.0 * (self.phase - gait.REST_PHASE) - 1e-6)
            rest = 0.5 * halves + gait.REST_PHASE
            self.phase = min(self.phase + self.cadence * dt, rest)
            if self.phase >= rest:
                self.cadence = 0.0
        return Intent(
            state="walk",
            task=self._task,
            phase=self.phase,
            cadence=self.cadence,
            speed=speed,
            side=side,
            turn=turn,
            lift=LIFT if self.cadence > 0.0 else 0.0,
        )
