"""Sit quietly: nothing is meant, but nobody sits perfectly still."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library.task import Task

SWAY = np.radians([1.0, 2.0, 0.7])


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=rng.uniform(-SWAY, SWAY) * difficulty)

    return keyframe_track(rng, "sit", "sit_quiet", seconds, goal)


TASK = Task(name="sit_quiet", state="sit", draw=_draw)
