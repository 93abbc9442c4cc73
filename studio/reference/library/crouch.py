"""Stand and bend the legs: the trunk goes down by up to 8 cm and up again."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library.task import Task, amplitude

LEAN = np.radians(6.0)


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    deepest = amplitude(difficulty, 0.4)

    def goal(rng: np.random.Generator) -> Goal:
        # People lean a little forward as they bend their knees.
        crouch = 0.0 if rng.random() < 0.25 else deepest * np.sqrt(rng.random())
        return Goal(tilt=np.array([0.0, LEAN * crouch * rng.random(), 0.0]), crouch=crouch)

    return keyframe_track(rng, "stand", "crouch", seconds, goal)


TASK = Task(name="crouch", state="stand", draw=_draw)
