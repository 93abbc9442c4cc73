"""How fast the robot really walks and turns, against what was asked."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from studio import geometry, metrics
from studio.evaluation.options import ScriptOptions
from studio.evaluation.scripted import controllers, record
from studio.reference import gait
from studio.reference.intent import IntentTrack
from studio.reference.marching import Bout, march_track
from studio.reference.tasks_travel import travel_track
from studio.robot.a1 import CONTROL_DT
from studio.training.machine import commit

CASES = [(speed, 0.0) for speed in (0.0, 0.2, 0.4, 0.6, 0.8, 0.97)] + [
    (speed, turn) for speed in (0.2, 0.4) for turn in (-15.0, 15.0)
]
"""Speed in m/s and turn in degrees a second, marched."""
THROUGH_SPACE = [
    (-0.2, 0.0, 0.0), (-0.4, 0.0, 0.0), (0.0, 0.3, 0.0), (0.0, -0.3, 0.0), (0.4, 0.3, 0.0),
    (0.4, 0.0, 30.0), (0.4, 0.0, -30.0), (0.0, 0.0, 60.0), (0.0, 0.0, -60.0), (0.4, 0.0, 60.0),
]  # fmt: skip
"""Speed ahead and to the left in m/s, turn in degrees a second, as of who crosses a room."""
SECONDS, SETTLE = 10.0, 3.0


@dataclass(frozen=True, kw_only=True)
class Options(ScriptOptions):
    """Of `evaluate walk`."""


def run_walk(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}` per speed, turn and controller, averaged from SETTLE s on.

    commanded: of the reference motion; achieved: of the simulated robot. drift_share: how far off
    the straight reference's end the robot is, over the way walked (turns: None).
    """
    seeds = range(options.seed, options.seed + options.episodes)
    return {"rows": [row for seed in seeds for row in _rows(seed)]}


@dataclass(frozen=True, kw_only=True)
class _Script:
    """case: what is asked. means: "march", or "through space". straight: it goes straight on."""

    case: str
    means: str
    straight: bool
    track: IntentTrack


def _scripts() -> list[_Script]:
    scripts = []
    for speed, turn in CASES:
        cadence = gait.slowest_cadence(speed + 0.02, 1.0)
        bout = Bout(
            half_strides=int(np.ceil(2.0 * SECONDS * cadence)),
            cadence=cadence,
            lift=float(gait.march_lift(cadence, speed)),
            turn=float(np.radians(turn)),
        )
        track = march_track("walk", SECONDS, [bout] if speed else [])
        case = f"{speed:g} m/s, {turn:g} deg/s"
        scripts.append(_Script(case=case, means="march", straight=not turn, track=track))
    ramp = np.minimum(np.arange(round(SECONDS / CONTROL_DT)) * CONTROL_DT, 1.0)[:, None]
    for ahead, left, turn in THROUGH_SPACE:
        track = travel_track(ramp * [ahead, left, np.radians(turn)])
        case = f"{ahead:g} and {left:g} m/s, {turn:g} deg/s"
        scripts.append(_Script(case=case, means="through space", straight=not turn, track=track))
    return scripts


def _rows(seed: int) -> list[dict[str, Any]]:
    scripts = _scripts()
    rows = []
    start = round(SETTLE / CONTROL_DT)
    for controller in controllers("walk"):
        done = record("walk", [s.track for s in scripts], controller, seed=seed)
        yaw = np.unwrap(geometry.heading(done.base_quat), axis=0)
        for i, script in enumerate(scripts):
            asked = done.motions[i]
            forward, side, turned = metrics.mean_velocity(
                done.base_pos[start:, i, :2], yaw[start:, i], CONTROL_DT
            )
            asked_yaw = np.unwrap(geometry.heading(asked.base_quat))
            asked_forward, asked_side, asked_turned = metrics.mean_velocity(
                asked.base_pos[start:, :2], asked_yaw[start:], CONTROL_DT
            )
            gap = np.linalg.norm(
                (done.base_pos[-1, i] - done.base_pos[0, i])[:2]
                - (asked.base_pos[-1] - asked.base_pos[1])[:2]
            )
            total = metrics.distance_m(asked.base_pos)
            rows.append(
                {
                    "case": script.case,
                    "means": script.means,
                    "controller": controller,
                    "seed": seed,
                    "episodes": 1,
                    "commit": commit(),
                    "commanded_m_s": float(asked_forward),
                    "achieved_m_s": float(forward),
                    "commanded_side_m_s": float(asked_side),
                    "achieved_side_m_s": float(side),
                    "commanded_deg_s": float(np.degrees(asked_turned)),
                    "achieved_deg_s": float(np.degrees(turned)),
                    "drift_share": float(gap / total) if script.straight and total > 0.5 else None,
                    "survived": bool(done.alive[-1, i]),
                }
            )
    return rows
