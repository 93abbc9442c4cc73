"""What a task is (name, state, a way to draw intents), and the draws that tasks share."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.reference import gait
from studio.reference.intent import IntentTrack, StateName
from studio.reference.keyframes import Goal

Array = NDArray[np.float64]

Draw = Callable[[np.random.Generator, float, float], IntentTrack]


@dataclass(frozen=True, kw_only=True)
class Task:
    """One task. draw(rng, seconds, difficulty) gives its random intents."""

    name: str
    state: StateName
    draw: Draw

    def sample(
        self, rng: np.random.Generator, seconds: float, difficulty: float = 1.0
    ) -> IntentTrack:
        """A random track at 30 Hz. difficulty in [0, 1]: 0 a third of the range, 1 all of it."""
        return self.draw(rng, seconds, min(max(difficulty, 0.0), 1.0))


def amplitude(difficulty: float, easiest: float = 0.3) -> float:
    """Share of a range to be used: from `easiest` at difficulty 0 to 1 at difficulty 1."""
    return easiest + (1.0 - easiest) * difficulty


def draw_tilt(rng: np.random.Generator, limit: Array) -> Array:
    """Roll, pitch, yaw (3,) within limit (3,) rad: one axis alone half of the time.

    Shares of several axes add up to at most one, as the legs cannot do 40 degrees on two at once.
    """
    share = np.zeros(3)
    if rng.random() < 0.5:
        share[rng.integers(3)] = rng.uniform(-1.0, 1.0)
    else:
        share = rng.dirichlet(np.ones(3)) * rng.choice([-1.0, 1.0], 3) * np.sqrt(rng.random())
    return share * limit


def draw_cadence(rng: np.random.Generator, fastest: float = 2.3) -> float:
    """Strides per second as people march (0.3 to 1), jog (1 to 1.5) and, for fast walks, beyond."""
    low, high = [(0.3, 1.0), (1.0, 1.5), (1.4, fastest)][rng.choice(3, p=[0.45, 0.25, 0.3])]
    return float(rng.uniform(low, high))


def draw_lift(rng: np.random.Generator, cadence: float, top_speed: float) -> float:
    """Thigh lift whose march at this cadence is no faster than top_speed m/s."""
    highest = float(gait.march_lift(cadence, top_speed))
    return float(min(rng.uniform(0.15, 1.0), highest))


def draw_paw_goal(rng: np.random.Generator, paw: int, difficulty: float) -> Goal:
    """Raise front paw `paw` (0 right, 1 left) somewhere; a fifth of the time put it down."""
    reach, side = np.zeros(2), np.zeros(2)
    if rng.random() > 0.2:
        reach[paw] = rng.uniform(0.25, 0.6 + 0.4 * difficulty)
        if rng.random() < 0.6:
            side[paw] = rng.uniform(-1.0, 1.0) * (0.4 + 0.6 * difficulty)
    return Goal(reach=reach, reach_side=side)
