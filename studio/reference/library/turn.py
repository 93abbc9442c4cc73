"""Walk and turn: up to 15 degrees a second to either side, changing on the way."""

import numpy as np

from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude
from studio.reference.marching import Bout, march_track

MAX_TURN = np.radians(15.0)


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    size = amplitude(difficulty)
    cadence = draw.cadence(rng)
    lift = draw.lift(rng, cadence, gait.MAX_SPEED * size)
    bouts, gone = [], 0.0
    while gone < seconds:
        half_strides = int(rng.integers(3, 9))
        turn = float(rng.uniform(-1.0, 1.0) * MAX_TURN * size)
        bouts.append(Bout(half_strides=half_strides, cadence=cadence, lift=lift, turn=turn))
        gone += 0.5 * half_strides / cadence
    return march_track("turn", seconds, bouts, lead=float(rng.uniform(0.1, 0.6)))


TASK = Task(name="turn", state="walk", draw=_draw)
