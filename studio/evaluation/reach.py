"""How high a paw gets, in physics: sitting to 0.8 m, which standing must fail.

Sitting raises both front paws; standing raises one on three legs, leaning back as far as its
reference library does. Nominal dynamics, no noise.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from studio.evaluation.options import ScriptOptions
from studio.evaluation.scripted import controllers, record
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.intent import IntentTrack
from studio.reference.tracks import frames_in, make_track
from studio.robot import kinematics
from studio.timing import CONTROL_HZ
from studio.training.machine import commit

TARGET_M = 0.8
"""The paper's high target."""
RAMP, HOLD = 2.0, 3.0
STANDING_PITCH = -np.radians(25.0)
"""Nose up: the most that the library combines with a raised paw."""


def _tracks(state: str) -> dict[str, IntentTrack]:
    """Each way of reaching up, with its paw: right, left, or both at once."""
    length = frames_in(RAMP + HOLD)
    share = minimum_jerk(np.arange(length) / CONTROL_HZ / RAMP)
    ways = {"right": (1.0, 0.0), "left": (0.0, 1.0)}
    if state == "sit":
        ways["both"] = (1.0, 1.0)
    tracks = {}
    for name, reach in ways.items():
        tilt = np.zeros((length, 3))
        if state == "stand":
            tilt[:, 1] = STANDING_PITCH * share
        asked = share[:, None] * np.array(reach)
        tracks[name] = make_track(state, "reach", length, tilt=tilt, reach=asked)  # type: ignore[arg-type]
    return tracks


@dataclass(frozen=True, kw_only=True)
class Options(ScriptOptions):
    """Of `evaluate reach`."""


def run_reach(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}` per state, paw and controller: `paw_m`, the lowest that the raised paws'
    soles were above the ground over the last second, and whether that is TARGET_M."""
    seeds = range(options.seed, options.seed + options.episodes)
    return {"rows": [row for seed in seeds for row in _rows(seed)]}


def _rows(seed: int) -> list[dict[str, Any]]:
    rows = []
    for state in ("stand", "sit"):
        tracks = _tracks(state)
        for controller in controllers(state):
            done = record(state, list(tracks.values()), controller, seed=seed)
            feet = kinematics.foot_pos_w(done.base_pos, done.base_quat, done.joint_pos)
            for i, paw in enumerate(tracks):
                raised = [0, 1] if paw == "both" else [0 if paw == "right" else 1]
                height = float(feet[-30:, i, raised, 2].min())
                survived = bool(done.alive[-1, i])
                rows.append(
                    {
                        "state": state,
                        "paw": paw,
                        "controller": controller,
                        "seed": seed,
                        "episodes": 1,
                        "commit": commit(),
                        "asked_m": TARGET_M,
                        "paw_m": height,
                        "reached": survived and height >= TARGET_M,
                        "survived": survived,
                    }
                )
    return rows
