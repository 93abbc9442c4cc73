"""Sitting tasks: on the haunches, with both front legs free."""

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.sitting import TILT_LIMIT
from studio.reference.task import Task, amplitude, draw_tilt

SWAY = np.radians([1.0, 2.0, 0.7])


def _sit_quiet(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Sit quietly: nothing is meant, but nobody sits perfectly still."""

    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=rng.uniform(-SWAY, SWAY) * difficulty)

    return keyframe_track(rng, "sit", "sit_quiet", seconds, goal)


def _sit_tilt(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Sit and tilt the trunk: 30 degrees of range in pitch, 15 in roll, 7 in yaw."""

    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=draw_tilt(rng, TILT_LIMIT * amplitude(difficulty)))

    return keyframe_track(rng, "sit", "sit_tilt", seconds, goal)


def _sit_manipulate(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Sit and use both front legs as arms: each paw from low before the trunk to above 0.8 m."""
    size = amplitude(difficulty)

    def goal(rng: np.random.Generator) -> Goal:
        reach = rng.uniform(0.0, size, 2) * (rng.random(2) > 0.15)
        if rng.random() < 0.3:  # both together, as when lifting a box
            reach[:] = reach[0]
        side = rng.uniform(-size, size, 2) * (rng.random(2) < 0.5)
        tilt = 0.5 * draw_tilt(rng, TILT_LIMIT * size) if rng.random() < 0.3 else np.zeros(3)
        return Goal(tilt=tilt, reach=reach, reach_side=side)

    return keyframe_track(rng, "sit", "sit_manipulate", seconds, goal)


SIT_TASKS = (
    Task(name="sit_quiet", state="sit", draw=_sit_quiet),
    Task(name="sit_tilt", state="sit", draw=_sit_tilt),
    Task(name="sit_manipulate", state="sit", draw=_sit_manipulate),
)
