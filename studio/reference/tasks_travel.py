"""Travelling: where a person goes through space, the robot goes: ahead, back, aside and around.

No march means it, so that no mapper learns it: the walking policy does (`rl.bank`), and live the
person's own velocity sets it (`retarget.travel`).
"""

import math

import numpy as np
from numpy.typing import NDArray

from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.stepping import Stepper, trot_cadence
from studio.reference.task import Task, amplitude
from studio.reference.tracks import frames_in, make_track
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

MAX_SPIN = math.radians(60.0)
"""rad/s: fastest turn."""
_SETTLED = 0.02


def draw_velocity(rng: np.random.Generator, size: float) -> Array:
    """(3,) m/s forward, m/s to the left, rad/s to the left, within `size` of each range.

    As often straight on, turning on the way, turning on the spot, to a side, and all at once.
    """
    low, high = -gait.MAX_BACK * size, gait.MAX_SPEED * size
    forward = rng.uniform(low, high)
    side = rng.uniform(-1.0, 1.0) * gait.MAX_SIDE * size
    turn = rng.uniform(-1.0, 1.0) * MAX_SPIN * size
    kind = rng.integers(5)
    used = [(1, 0, 0), (1, 0, 1), (0, 0, 1), (0, 1, 0), (1, 1, 1)][kind]
    return np.array([forward, side, turn]) * used


def _travel(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """One velocity after another, each for some seconds, with halts in between."""
    size = amplitude(difficulty)
    length = frames_in(seconds)
    wanted = np.zeros((length, 3))
    at = round(rng.uniform(0.1, 0.6) / CONTROL_DT)
    while at < length:
        hold = round(rng.uniform(1.0, 4.0) / CONTROL_DT)
        halt = rng.random() < 0.15
        wanted[at : at + hold] = 0.0 if halt else draw_velocity(rng, size)
        at += hold
    # People change their speed over some tenths of a second: two equal low-passes in a row.
    share = CONTROL_DT / rng.uniform(0.1, 0.3)
    velocity, middle = np.zeros((length, 3)), np.zeros(3)
    for k in range(1, length):
        middle = middle + share * (wanted[k] - middle)
        velocity[k] = velocity[k - 1] + share * (middle - velocity[k - 1])
    return travel_track(velocity)


def travel_track(velocity: Array) -> IntentTrack:
    """The walk of (T, 3), a period each: m/s ahead, m/s to the left, rad/s to the left."""
    stepper, intents = Stepper("travel"), []
    for forward, side, turn in velocity.tolist():
        goes = math.hypot(forward, side) + 0.2 * abs(turn) > _SETTLED
        cadence = trot_cadence(forward, side, turn) if goes else 0.0
        intents.append(stepper.step(CONTROL_DT, cadence, forward, side, turn))
    names = ("phase", "cadence", "lift", "speed", "side", "turn")
    rows = {name: np.array([getattr(i, name) for i in intents]) for name in names}
    return make_track("walk", "travel", len(velocity), CONTROL_DT, **rows)


TRAVEL = Task(name="travel", state="walk", draw=_travel)
