"""Standing tasks: what is meant while at least three feet carry."""

from dataclasses import replace

import numpy as np

from studio.reference.intent import IntentTrack
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.standing import FULL_TILT
from studio.reference.task import Task, amplitude, draw_paw_goal, draw_tilt

SWAY = np.radians(3.0)
TILT = np.full(3, FULL_TILT)
CROUCH_LEAN = np.radians(6.0)
TILT_REACHING = np.radians([25.0, 25.0, 25.0])


def _quiet(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand quietly: nothing is meant, but nobody stands perfectly still."""

    def goal(rng: np.random.Generator) -> Goal:
        return Goal(tilt=rng.uniform(-SWAY, SWAY, 3) * difficulty, crouch=rng.uniform(0.0, 0.05))

    return keyframe_track(rng, "stand", "quiet", seconds, goal)


def _tilt(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand and tilt the trunk: roll, pitch and yaw up to 40 degrees."""

    def goal(rng: np.random.Generator) -> Goal:
        crouch = rng.uniform(0.0, 0.6) if rng.random() < 0.3 else 0.0
        return Goal(tilt=draw_tilt(rng, TILT * amplitude(difficulty)), crouch=crouch)

    return keyframe_track(rng, "stand", "tilt", seconds, goal)


def _crouch(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand and bend the legs: the trunk goes down by up to 8 cm and up again."""
    deepest = amplitude(difficulty, 0.4)

    def goal(rng: np.random.Generator) -> Goal:
        # People lean a little forward as they bend their knees.
        crouch = 0.0 if rng.random() < 0.25 else deepest * np.sqrt(rng.random())
        return Goal(tilt=np.array([0.0, CROUCH_LEAN * crouch * rng.random(), 0.0]), crouch=crouch)

    return keyframe_track(rng, "stand", "crouch", seconds, goal)


def _manipulate_right(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand on three legs and reach with the front right paw."""
    return keyframe_track(
        rng, "stand", "manipulate_right", seconds, lambda rng: draw_paw_goal(rng, 0, difficulty)
    )


def _manipulate_left(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand on three legs and reach with the front left paw."""
    return keyframe_track(
        rng, "stand", "manipulate_left", seconds, lambda rng: draw_paw_goal(rng, 1, difficulty)
    )


def _tilt_manipulate(rng: np.random.Generator, seconds: float, difficulty: float) -> IntentTrack:
    """Stand on three legs, reach with a paw and tilt the trunk at once: a far larger workspace."""
    paw = int(rng.integers(2))

    def goal(rng: np.random.Generator) -> Goal:
        tilt = draw_tilt(rng, TILT_REACHING * amplitude(difficulty))
        return replace(draw_paw_goal(rng, paw, difficulty), tilt=tilt)

    return keyframe_track(rng, "stand", "tilt_manipulate", seconds, goal)


STAND_TASKS = (
    Task(name="quiet", state="stand", draw=_quiet),
    Task(name="tilt", state="stand", draw=_tilt),
    Task(name="crouch", state="stand", draw=_crouch),
    Task(name="manipulate_right", state="stand", draw=_manipulate_right),
    Task(name="manipulate_left", state="stand", draw=_manipulate_left),
    Task(name="tilt_manipulate", state="stand", draw=_tilt_manipulate),
)
