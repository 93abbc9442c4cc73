"""The people table: real motion clips driven through the whole flow, scored against their labels.

A score on one's own generator proves little; this table decides. A folder of clips carries
`labels.json`: per file, intervals in seconds with the expert a careful person would expect.
"""

import logging
from contextlib import closing
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from studio import metrics
from studio.control.drive_command import PuppeteerConfig
from studio.evaluation.behind import drive, met
from studio.evaluation.clips import read_labels
from studio.evaluation.drive_report import DriveReport, tilt_against_feet, tilt_ranges
from studio.evaluation.options import TableOptions
from studio.evaluation.people_starts import start_rows
from studio.options import ControllerName, Style
from studio.reference.stances import NEUTRAL
from studio.retarget.experts import EXPERTS
from studio.robot import kinematics
from studio.robot.a1 import CONTROL_DT, FOOT_RADIUS
from studio.sources import open_source, spec_of
from studio.synthetic.impaired import real_sent_by
from studio.takes.tick import Tick
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]
SensorName = Literal["mocap", "dropped", "kinect", "webcam"]

GOAL_OVERALL, GOAL_EACH = 0.90, 0.75
"""Share of labelled frames with the right expert: over all clips, and on each."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate people`."""

    clips: Path
    """Folder of real motion clips with a labels.json."""
    episodes: int | None = None
    """At most so many of the clips, the first ones (default: all)."""
    style: Style = "march"
    """Which human motion means walking."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    sensor: SensorName | None = None
    """As this sensor would have sent them: late, noisy, with frames and limbs lost (default: as
    they are)."""
    starts: float | None = None
    """Instead of labels, falls: every clip, in folders below too, begun anew each so many s."""


def run_people(options: Options) -> dict[str, Any]:
    """A row per clip and one for all together (case "all"). StudioError without labelled clips."""
    made_by = commit()
    if options.starts is not None:
        rows = start_rows(
            options.clips,
            options.starts,
            style=options.style,
            controller=options.controller,
            seed=options.seed,
            most=options.episodes,
        )
        return {"rows": [{"episodes": row["starts"], **row, "commit": made_by} for row in rows]}
    labels = list(read_labels(options.clips).items())[: options.episodes]
    rows = [clip_row(options, name, intervals) for name, intervals in labels]
    rows.append(overall(rows) | {"episodes": len(rows)})
    return {"rows": [{"episodes": 1, **row, "commit": made_by} for row in rows]}


def frame_labels(t: NDArray, intervals: list[dict[str, Any]]) -> list[str]:
    """The expected expert of each time (T,) s, "" where there is no label."""
    out = [""] * len(t)
    for interval in intervals:
        for i in np.flatnonzero((t >= interval["from"]) & (t <= interval["to"])):
            out[i] = interval["expert"]
    return out


def drive_clip(options: Options, name: str) -> list[Tick]:
    """Every tick of a clip, to its end even if the robot falls on the way."""
    spec = spec_of(options.clips / name)
    config = PuppeteerConfig(style=options.style, controller=options.controller, seed=options.seed)
    with closing(open_source(spec, seed=options.seed, style=options.style)) as opened:
        source = opened
        if options.sensor is not None:
            source = real_sent_by(options.sensor, opened, options.seed)
        return list(drive(met(source, config), source, through_falls=True))


def clip_row(options: Options, name: str, intervals: list[dict[str, Any]]) -> dict[str, Any]:
    """One clip's figures: the selector's against the labels, the robot's from physics."""
    ticks = drive_clip(options, name)
    t = np.arange(len(ticks)) * CONTROL_DT
    expected = frame_labels(t, intervals)
    chosen = [tick.expert for tick in ticks]
    labelled = [i for i, e in enumerate(expected) if e]
    right = [i for i in labelled if chosen[i] == expected[i]]
    fell_at = next((i for i, tick in enumerate(ticks) if tick.fallen), None)
    alive = ticks if fell_at is None else ticks[: fell_at + 1]
    report = DriveReport()
    for tick in alive:
        report.add(tick)
    summary = report.summary(len(ticks) * CONTROL_DT)
    heights = np.array([tick.robot.base_pos[2] for tick in alive])
    row: dict[str, Any] = {
        "case": name,
        "sensor": options.sensor,
        "controller": summary["controller"],
        "seed": options.seed,
        "frames": len(ticks),
        "labelled": len(labelled),
        "right": len(right),
        "right_share": len(right) / len(labelled) if labelled else None,
        "unknown_share": chosen.count("unknown") / max(len(chosen), 1),
        "base_drop_m": float(NEUTRAL["stand"].base_pos[2] - heights.min()),
        "reference": _reference(ticks),
    }
    for state in EXPERTS:
        of_state = [i for i in labelled if expected[i] == state]
        hits = sum(chosen[i] == state for i in of_state)
        row[f"right_share_{state}"] = hits / len(of_state) if of_state else None
    for key in (
        "expert_share",
        "tilt_deg",
        "paw_height_m",
        "distance_m",
        "survived",
        "survival_ratio",
        "clipped_share",
        "foot_skate_m_s",
        "reference_foot_skate_m_s",
        "inference_ms",
    ):
        row[key] = summary[key]
    log.info("%s: %s right, survived %s", name, row["right_share"], row["survived"])
    return row


def overall(rows: list[dict[str, Any]]) -> dict[str, Any]:
    """All clips as one, and whether the goals on the selector are met."""
    labelled, right = sum(r["labelled"] for r in rows), sum(r["right"] for r in rows)
    shares = [r["right_share"] for r in rows if r["right_share"] is not None]
    frames = sum(r["frames"] for r in rows)
    share = right / labelled if labelled else None
    return {
        "case": "all",
        "sensor": rows[0]["sensor"],
        "controller": rows[0]["controller"],
        "seed": rows[0]["seed"],
        "frames": frames,
        "labelled": labelled,
        "right": right,
        "right_share": share,
        "worst_right_share": min(shares, default=None),
        "unknown_share": sum(r["unknown_share"] * r["frames"] for r in rows) / frames,
        "survived": all(r["survived"] for r in rows),
        "goals_met": bool(share is not None and share >= GOAL_OVERALL and min(shares) >= GOAL_EACH),
    }


def _reference(ticks: list[Tick]) -> dict[str, Any]:
    """What the kinematic robot does, whatever physics makes of it: tilt, paws, height, way."""
    ref = [tick.reference for tick in ticks]
    pos, quat, joints = (
        np.array([getattr(r, f) for r in ref]) for f in ("base_pos", "base_quat", "joint_pos")
    )
    feet = kinematics.foot_pos_w(pos, quat, joints)
    paws = feet[:, :2, 2] - FOOT_RADIUS
    tilt = [
        tilt_against_feet(tick, quat[i], feet[i])
        for i, tick in enumerate(ticks)
        if tick.state != "transition"
    ]
    return {
        "tilt_deg": tilt_ranges(tilt),
        "paw_height_m": {
            leg: [float(paws[:, i].min()), float(paws[:, i].max())]
            for i, leg in enumerate(("FR", "FL"))
        },
        "base_height_m": [float(pos[:, 2].min()), float(pos[:, 2].max())],
        "distance_m": metrics.distance_m(pos),
    }
