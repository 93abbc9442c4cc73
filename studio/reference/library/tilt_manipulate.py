"""Stand on three legs, reach with a paw and tilt the trunk at once: a far larger workspace."""

from dataclasses import replace

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude

LIMIT = np.radians([25.0, 25.0, 25.0])


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    paw = int(rng.integers(2))

    def goal(rng: np.random.Generator) -> Goal:
        tilt = draw.tilt(rng, LIMIT * amplitude(difficulty))
        return replace(draw.paw_goal(rng, paw, difficulty), tilt=tilt)

    return keyframe_track(rng, "stand", "tilt_manipulate", seconds, goal)


TASK = Task(name="tilt_manipulate", state="stand", draw=_draw)
