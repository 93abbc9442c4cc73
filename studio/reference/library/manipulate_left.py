"""Stand on three legs and reach with the front left paw."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    return keyframe_track(
        rng, "stand", "manipulate_left", seconds, lambda rng: draw.paw_goal(rng, 1, difficulty)
    )


TASK = Task(name="manipulate_left", state="stand", draw=_draw)
