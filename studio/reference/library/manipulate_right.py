"""Stand on three legs and reach with the front right paw."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    return keyframe_track(
        rng, "stand", "manipulate_right", seconds, lambda rng: draw.paw_goal(rng, 0, difficulty)
    )


TASK = Task(name="manipulate_right", state="stand", draw=_draw)
