"""Stand quietly: nothing is meant, but nobody stands perfectly still."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library.task import Task

SWAY = np.radians(3.0)


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=rng.uniform(-SWAY, SWAY, 3) * difficulty, crouch=rng.uniform(0.0, 0.05))

    return keyframe_track(rng, "stand", "quiet", seconds, goal)


TASK = Task(name="quiet", state="stand", draw=_draw)
