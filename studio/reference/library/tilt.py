"""Stand and tilt the trunk: roll, pitch and yaw up to 40 degrees."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude

LIMIT = np.radians([40.0, 40.0, 40.0])


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    def goal(rng: np.random.Generator) -> Goal:
        crouch = rng.uniform(0.0, 0.6) if rng.random() < 0.3 else 0.0
        return Goal(tilt=draw.tilt(rng, LIMIT * amplitude(difficulty)), crouch=crouch)

    return keyframe_track(rng, "stand", "tilt", seconds, goal)


TASK = Task(name="tilt", state="stand", draw=_draw)
