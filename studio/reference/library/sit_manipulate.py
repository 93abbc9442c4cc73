"""Sit and use both front legs as arms: each paw from low before the trunk to above 0.8 m."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude
from studio.reference.sitting import TILT_LIMIT


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    size = amplitude(difficulty)

    def goal(rng: np.random.Generator) -> Goal:
        reach = rng.uniform(0.0, size, 2) * (rng.random(2) > 0.15)
        if rng.random() < 0.3:  # both together, as when lifting a box
            reach[:] = reach[0]
        side = rng.uniform(-size, size, 2) * (rng.random(2) < 0.5)
        tilt = 0.5 * draw.tilt(rng, TILT_LIMIT * size) if rng.random() < 0.3 else np.zeros(3)
        return Goal(tilt=tilt, reach=reach, reach_side=side)

    return keyframe_track(rng, "sit", "sit_manipulate", seconds, goal)


TASK = Task(name="sit_manipulate", state="sit", draw=_draw)
