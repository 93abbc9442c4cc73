"""Walk straight on: 0 to 0.97 m/s, by a crawl or a trot as the cadence asks."""

import numpy as np

from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude
from studio.reference.marching import Bout, march_track


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    top = gait.MAX_SPEED * amplitude(difficulty)
    cadence = draw.cadence(rng)
    bout = Bout(
        half_strides=int(np.ceil(2.0 * seconds * cadence)),
        cadence=cadence,
        lift=draw.lift(rng, cadence, top),
        ramp=float(rng.uniform(0.4, 1.2)),
    )
    crouch = float(rng.uniform(0.0, 1.0)) if rng.random() < 0.3 else 0.0
    return march_track("walk", seconds, [bout], lead=float(rng.uniform(0.1, 0.6)), crouch=crouch)


TASK = Task(name="walk", state="walk", draw=_draw)
