"""Intents as rows of numbers, so that one second or one frame runs through the same code."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import Intent, IntentTrack
from studio.timing import CONTROL_DT

Array = NDArray[np.float64]

# Columns of a signal (T, NUM): the fields of Intent, then the state as two weights.
TILT = slice(0, 3)
CROUCH = 3
REACH = slice(4, 6)
SIDE = slice(6, 8)
SPEED, TURN, CADENCE, LIFT = 8, 9, 10, 11
WALK, SIT = 12, 13
PHASE = 14
NUM = 15

DT = CONTROL_DT
"""s between frames of the person, whatever drives them."""


def of_intents(intents: Sequence[Intent]) -> Array:
    """(T, NUM) signal of intents one control period apart."""
    out = np.zeros((len(intents), NUM))
    for row, intent in zip(out, intents):
        row[TILT] = intent.tilt
        row[CROUCH] = intent.crouch
        row[REACH] = intent.reach
        row[SIDE] = intent.reach_side
        row[SPEED], row[TURN] = intent.speed, intent.turn
        row[CADENCE], row[LIFT] = intent.cadence, intent.lift
        row[WALK] = intent.state == "walk"
        row[SIT] = intent.state == "sit"
        row[PHASE] = intent.phase
    return out


def of_track(track: IntentTrack) -> Array:
    """(T, NUM) signal of a track at 30 Hz."""
    assert abs(track.dt - DT) < 1e-6, track.dt
    out = np.zeros((len(track), NUM))
    out[:, TILT] = track.tilt
    out[:, CROUCH] = track.crouch
    out[:, REACH] = track.reach
    out[:, SIDE] = track.reach_side
    out[:, SPEED], out[:, TURN] = track.speed, track.turn
    out[:, CADENCE], out[:, LIFT] = track.cadence, track.lift
    out[:, WALK] = track.state == "walk"
    out[:, SIT] = track.state == "sit"
    out[:, PHASE] = track.phase
    return out


def leg_phase(phase: Array) -> Array:
    """(T, 2) phase of the (right, left) leg in [0, 1); the left foot lifts at 0."""
    return (phase[:, None] + np.array([0.5, 0.0])) % 1.0
