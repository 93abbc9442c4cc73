"""Sit and tilt the trunk: 30 degrees of range in pitch, 15 in roll, 7 in yaw."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.library import draw
from studio.reference.library.task import Task, amplitude
from studio.reference.sitting import TILT_LIMIT


def _draw(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=draw.tilt(rng, TILT_LIMIT * amplitude(difficulty)))

    return keyframe_track(rng, "sit", "sit_tilt", seconds, goal)


TASK = Task(name="sit_tilt", state="sit", draw=_draw)
