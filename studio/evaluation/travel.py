"""Who crosses the room: how fast the person asks to go, at the robot's size, and what it does.

Real clips (`--clips`) and synthetic people who go ahead, back, aside and around.
"""

import logging
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics
from studio.control.drive_command import PuppeteerConfig
from studio.evaluation.behind import drive, met
from studio.evaluation.clips import clips_below
from studio.evaluation.options import TableOptions
from studio.mocap.source import Source
from studio.options import ControllerName
from studio.robot.a1 import CONTROL_DT
from studio.sources import open_source, spec_of
from studio.synthetic.travelling import AT_PERSONS_SIZE, Travelling
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

WAYS: dict[str, tuple[float, float, float]] = {
    "ahead .3": (0.3, 0.0, 0.0),
    "ahead .6": (0.6, 0.0, 0.0),
    "ahead .9": (0.9, 0.0, 0.0),
    "back .2": (-0.2, 0.0, 0.0),
    "back .4": (-0.4, 0.0, 0.0),
    "left .2": (0.0, 0.2, 0.0),
    "right .3": (0.0, -0.3, 0.0),
    "ahead .4, left 30": (0.4, 0.0, 30.0),
    "ahead .4, right 60": (0.4, 0.0, -60.0),
}
"""Synthetic people's way, at the robot's size: m/s forward, to the left, degrees/s to the left."""
SECONDS = 12.0
WINDOW = 30
"""Control periods (1 s) over which what is asked and what is done are compared."""
MOVES, TURNS = 0.1, 15.0
"""m/s and degrees/s asked for, from which a window travels, and turns."""
GOAL_SPEED, GOAL_SIGN = 0.15, 0.95
"""m/s, median error of the speed; share of the turns whose sign is right."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate travel`."""

    clips: Path | None = None
    """Folder of real motion clips; folders below count."""
    episodes: int = 4
    """Synthetic people a way."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""


def run_travel(options: Options = Options()) -> dict[str, Any]:
    """A row per clip that travels and per way of synthetic people, and one for each kind."""
    config = PuppeteerConfig(controller=options.controller, seed=options.seed)
    rows = []
    for name, way in WAYS.items():
        velocity = np.array(way) * AT_PERSONS_SIZE * [1.0, 1.0, np.pi / 180.0]
        seeds = range(options.seed, options.seed + options.episodes)
        runs = [follow(_person(seed, velocity), config) for seed in seeds]
        rows.append(_row(name, "synthetic", runs, options.seed))
    rows.append(_row("all", "synthetic", [run for row in rows for run in row["runs"]], 0))
    if options.clips is not None:
        clips = [_clip(path) for path in clips_below(options.clips)]
        found = [(name, follow(opened, config)) for name, opened in clips]
        real = [(name, run) for name, run in found if len(run.asked)]
        rows += [_row(name, "real", [run], options.seed) for name, run in real]
        if real:
            rows.append(_row("all", "real", [run for _, run in real], options.seed))
    for row in rows:
        del row["runs"]
        row["controller"] = options.controller or "policy"
        log.info("%s", row)
    return {"rows": rows}


@dataclass(frozen=True, kw_only=True)
class Run:
    """One person followed. asked, reference, done: (W, 3) m/s forward, to the left, rad/s, of each
    window in which they travel and the robot walks, the person's at the robot's size, in the
    heading of each. apart: (W,) m between where robot and person went, across the person's way.
    """

    asked: Array
    reference: Array
    done: Array
    apart: Array
    fell: bool


def follow(open_it: Callable[[], Source], config: PuppeteerConfig) -> Run:
    """Drive a source to its end, or for SECONDS."""
    source = open_it()
    puppeteer = met(source, config)
    path = puppeteer.retargeter.path
    rows: list[tuple[Array, Array, Array, bool]] = []
    fell = False
    for tick in drive(puppeteer, source, source.duration or SECONDS):
        if tick.fallen:
            fell = True
            break
        ref, robot = tick.reference, tick.robot
        where = [
            np.append(path.pos, path.heading),
            np.append(ref.base_pos[:2], geometry.heading(ref.base_quat)),
            np.append(robot.base_pos[:2], geometry.heading(robot.base_quat)),
        ]
        rows.append((*where, tick.state == "walk" and puppeteer.retargeter.travels))
    source.close()
    person, reference, robot = (np.array([row[i] for row in rows]) for i in range(3))
    moving = np.array([row[3] for row in rows])
    ends = [k for k in range(WINDOW, len(rows), WINDOW // 2) if moving[k - WINDOW : k + 1].all()]
    asked, reference, done = (
        np.array([_velocity(each, k) for k in ends]).reshape(-1, 3)
        for each in (person, reference, robot)
    )
    apart = np.array([_apart(person, robot, k) for k in ends])
    return Run(asked=asked, reference=reference, done=done, apart=apart, fell=fell)


def _velocity(place: Array, k: int) -> Array:
    """Mean velocity over the window before row `k` of (T, 3) places, in its mean heading."""
    part = place[k - WINDOW : k + 1]
    return metrics.mean_velocity(part[:, :2], np.unwrap(part[:, 2]), CONTROL_DT)


def _apart(person: Array, robot: Array, k: int) -> float:
    """m by which the robot's way of a window misses the person's, across it."""
    first = k - WINDOW

    def way(place: Array) -> Array:
        return geometry.turn_xy(place[k, :2] - place[first, :2], -place[first, 2])

    theirs, ours = way(person), way(robot)
    size = float(np.hypot(*theirs))
    return abs(float(theirs[0] * ours[1] - theirs[1] * ours[0])) / size if size > 0.02 else 0.0


def _row(name: str, kind: str, runs: list[Run], seed: int) -> dict[str, Any]:
    asked, reference, done = (
        np.concatenate([getattr(run, field) for run in runs])
        for field in ("asked", "reference", "done")
    )
    apart = np.concatenate([run.apart for run in runs])
    moves = np.hypot(asked[:, 0], asked[:, 1]) > MOVES
    turns = np.abs(np.degrees(asked[:, 2])) > TURNS
    error = np.hypot(*(done - asked)[moves, :2].T)
    right = np.sign(done[turns, 2]) == np.sign(asked[turns, 2])
    middle = [np.median(each[moves], axis=0) if moves.any() else None for each in (asked, done)]
    return {
        "case": name,
        "kind": kind,
        "seed": seed,
        "episodes": len(runs),
        "commit": commit(),
        "windows": int(moves.sum()),
        "asked_m_s": None if middle[0] is None else middle[0][:2].round(3).tolist(),
        "done_m_s": None if middle[1] is None else middle[1][:2].round(3).tolist(),
        "asked_deg_s": None if middle[0] is None else float(np.degrees(middle[0][2])),
        "done_deg_s": None if middle[1] is None else float(np.degrees(middle[1][2])),
        "speed_error_m_s": float(np.median(error)) if len(error) else None,
        "reference_error_m_s": float(np.median(np.hypot(*(reference - asked)[moves, :2].T)))
        if moves.any()
        else None,
        "turns": int(turns.sum()),
        "turn_sign_right": float(right.mean()) if len(right) else None,
        "apart_m": float(np.median(apart[moves])) if moves.any() else None,
        "fell": sum(run.fell for run in runs),
        "runs": runs,
    }


def _person(seed: int, velocity: Array) -> Callable[[], Source]:
    return lambda: Travelling(seed, velocity)


def _clip(path: Path) -> tuple[str, Callable[[], Source]]:
    return path.name, lambda: open_source(spec_of(path))
