"""How far the trunk tilts on each axis, standing and sitting, against what was asked."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from studio.evaluation.options import ScriptOptions
from studio.evaluation.scripted import controllers, record
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.intent import StateName
from studio.reference.sitting import TILT_LIMIT
from studio.reference.stances import tilt_of
from studio.reference.tasks_stand import TILT
from studio.reference.tracks import frames_in, make_track
from studio.timing import CONTROL_HZ
from studio.training.machine import commit

AXES = ("roll", "pitch", "yaw")
ASKED_DEG: dict[StateName, tuple[float, ...]] = {
    "stand": tuple(np.degrees(TILT).round(9)),
    "sit": tuple(np.degrees(TILT_LIMIT).round(9)),
}
"""To either side of neutral: the paper's ±40 standing; 15, 30 and 7 degrees of range sitting."""
RAMP, HOLD = 2.0, 3.0


@dataclass(frozen=True, kw_only=True)
class Options(ScriptOptions):
    """Of `evaluate tilt`."""


def run_tilt(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}`: per state, axis, side and controller `commanded_deg`, `achieved_deg`."""
    seeds = range(options.seed, options.seed + options.episodes)
    return {"rows": [row for seed in seeds for row in _rows(seed)]}


def _rows(seed: int) -> list[dict[str, Any]]:
    rows = []
    for state, limits in ASKED_DEG.items():
        cases = [(k, sign * limits[k]) for k in range(3) for sign in (-1.0, 1.0)]
        length = frames_in(RAMP + HOLD)
        share = minimum_jerk(np.arange(length) / CONTROL_HZ / RAMP)
        tracks = []
        for axis, angle in cases:
            tilt = np.zeros((length, 3))
            tilt[:, axis] = np.radians(angle) * share
            tracks.append(make_track(state, "tilt", length, tilt=tilt))
        for controller in controllers(state):
            done = record(state, tracks, controller, seed=seed)
            tilts = np.degrees(tilt_of(state, done.base_quat[-30:]))
            for i, (axis, angle) in enumerate(cases):
                asked = np.degrees(tilt_of(state, done.motions[i].base_quat[-1]))[axis]
                rows.append(
                    {
                        "state": state,
                        "axis": AXES[axis],
                        "controller": controller,
                        "seed": seed,
                        "episodes": 1,
                        "commit": commit(),
                        "commanded_deg": angle,
                        "reference_deg": float(asked),
                        "achieved_deg": float(np.mean(tilts[:, i, axis])),
                        "survived": bool(done.alive[-1, i]),
                    }
                )
    return rows
