"""A task's intents between two rests: quiet, the motion, home again, quiet.

A motion to be acted out has to be told apart from the one before and after it; the quiet ends also
settle which stride of a gait goes with which (see `takes.align.alignment`).
"""

from dataclasses import fields, replace

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import minimum_jerk
from studio.reference import gait
from studio.reference.intent import IntentTrack

Array = NDArray[np.float64]

HOME_S = 1.5
"""s to come back to neutral: the largest tilt at well under 120 degrees a second in every joint."""
LOWER_S = 1.7
"""s more for a paw that is all the way up."""
STOP_S = 1.0
"""s at least in which a walk runs out."""
_ARRAYS = tuple(f.name for f in fields(IntentTrack) if f.name not in ("state", "task", "dt"))


def between_rests(track: IntentTrack, quiet_s: float) -> IntentTrack:
    """The track with `quiet_s` s of rest before it and after it, and a way home before the last.

    At rest everything is zero but a walk's phase, which stays where all feet are down.
    """
    rows = {name: np.asarray(getattr(track, name), dtype=np.float64) for name in _ARRAYS}
    rows = _stopped(rows, track.dt) if track.state == "walk" else _home(rows, track.dt)
    length = round(quiet_s / track.dt)
    for name, row in rows.items():
        ends = row if name == "phase" else np.zeros_like(row)
        before = np.repeat(ends[:1], length, axis=0)
        after = np.repeat(ends[-1:], length, axis=0)
        rows[name] = np.concatenate([before, row, after])
    return replace(track, **rows)


def beats(track: IntentTrack) -> Array:
    """(B,) s at which a foot lifts, left and right by turns: what a metronome ticks to."""
    half = np.floor(2.0 * (track.phase - gait.REST_PHASE + 0.5) + 1e-9)
    steps = np.flatnonzero(np.diff(half) > 0) + 1
    return np.asarray(steps[track.cadence[steps] > 0.05] * track.dt, dtype=np.float64)


def _home(rows: dict[str, Array], dt: float) -> dict[str, Array]:
    """Everything back to zero by a minimum-jerk curve."""
    count = round((HOME_S + LOWER_S * float(rows["reach"][-1].max())) / dt)
    left = 1.0 - minimum_jerk(np.arange(1, count + 1) / count)
    return {
        name: np.concatenate([row, row[-1] * left.reshape(-1, *[1] * (row.ndim - 1))])
        for name, row in rows.items()
    }


def _stopped(rows: dict[str, Array], dt: float) -> dict[str, Array]:
    """The march goes on to the end of a half stride at least STOP_S away, ever lower and slower."""
    cadence, phase = float(rows["cadence"][-1]), float(rows["phase"][-1])
    stands = abs((2.0 * (phase - gait.REST_PHASE) + 0.5) % 1.0 - 0.5) < 1e-3
    if stands and cadence < 0.05:
        count = round(HOME_S / dt)  # a crouch, if there is one, goes home
        goal = phase
    else:
        cadence = max(cadence, 0.3)
        least = phase + max(STOP_S * cadence, 0.5)
        goal = np.ceil(2.0 * (least - gait.REST_PHASE) - 1e-6) / 2.0 + gait.REST_PHASE
        count = max(2, round((goal - phase) / cadence / dt))
    share = np.arange(1, count + 1) / count
    left = 1.0 - minimum_jerk(share)
    out = {}
    for name, row in rows.items():
        if name == "phase":
            tail = phase + share * (goal - phase)
        elif name == "cadence":
            tail = np.full(count, (goal - phase) / (count * dt))
        else:
            tail = row[-1] * left.reshape(-1, *[1] * (row.ndim - 1))
        out[name] = np.concatenate([row, tail])
    return out
