"""March as people do in place: a few steps, a pause, steps at another pace, a stop."""

import numpy as np

from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude
from studio.reference.library.turn import MAX_TURN
from studio.reference.marching import Bout, march_track


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    size = amplitude(difficulty)
    bouts, gone = [], 0.0
    while gone < seconds:
        cadence = draw.cadence(rng, fastest=1.8)
        bout = Bout(
            half_strides=int(rng.integers(2, 9)),
            cadence=cadence,
            lift=draw.lift(rng, cadence, gait.MAX_SPEED * size),
            turn=float(rng.uniform(-1.0, 1.0) * MAX_TURN * size) if rng.random() < 0.3 else 0.0,
            pause=float(rng.uniform(0.1, 1.5)),
            ramp=float(rng.uniform(0.3, 1.0)),
        )
        bouts.append(bout)
        gone += 0.5 * bout.half_strides / cadence + bout.pause
    return march_track("march", seconds, bouts, lead=float(rng.uniform(0.1, 1.0)))


TASK = Task(name="march", state="walk", draw=_draw)
