"""How high a paw comes by how high the wrist is: standing, on people nobody trained on.

Synthetic people raise a hand to one height after another, elbow first or arm first; real clips
(`--clips`) do what they do. Frames of the standing state, sorted by where the higher wrist is.
"""

import logging
from collections.abc import Iterator
from contextlib import closing
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation.behind import drive, met
from studio.evaluation.clips import clips_below
from studio.evaluation.options import TableOptions
from studio.geometry.time_scaling import smoothstep
from studio.human.calibration import calibrate
from studio.human.skeleton import INDEX
from studio.options import ControllerName
from studio.puppeteer import Puppeteer
from studio.reference.intent import IntentTrack
from studio.reference.stances import NEUTRAL
from studio.reference.tracks import frames_in, make_track
from studio.robot import kinematics
from studio.robot.a1 import FOOT_RADIUS
from studio.sources import open_source, spec_of
from studio.synthetic import Person, play
from studio.synthetic import signals as sig
from studio.synthetic.person import HELD_OUT_SEED
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

BINS = (0.3, 0.5, 0.7, 0.9, 1.1, 1.4)
"""Heights of a wrist at which rows part: 0 at the hip, 1 at the shoulder."""
ALIKE = 0.15
"""Two wrists no further apart in height are held alike; raised by less, a hand hangs."""
UP_M = 0.02
"""A paw is up from here on."""
TRUNK_M = 0.35
"""Of hip to shoulder, upright: who bends lower is left out, as no height is told from another."""
HEIGHTS = (0.3, 0.4, 0.5, 0.75, 1.0)
"""Reaches that a synthetic person goes to one after another: a half is at the shoulder."""
REST_S, MOVE_S, HOLD_S = 1.5, 0.6, 1.5


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate hands`."""

    clips: Path | None = None
    """Folder of real motion clips; folders below count."""
    episodes: int = 4
    """Synthetic people, each with arms straight and elbows first."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""


@dataclass(frozen=True, kw_only=True)
class Seen:
    """Standing frames: wrist (T, 2) as in BINS, right and left; soles' height (T, 2) m above the
    floor and forward of neutral (T, 2) m of the reference, and the robot's height."""

    wrist: Array
    asked: Array
    forward: Array
    done: Array
    fell: bool = False


def run_hands(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}` by kind of people and height of the higher wrist, the other hanging; of
    hands that both hang, and that are held alike below the shoulders."""
    config = PuppeteerConfig(controller=options.controller, seed=options.seed)
    people = range(HELD_OUT_SEED + options.seed, HELD_OUT_SEED + options.seed + options.episodes)
    kinds = {
        "straight arm": (acted(seed, 0.0, config) for seed in people),
        "elbow first": (acted(seed, 1.0, config) for seed in people),
    }
    if options.clips is not None:
        kinds["real"] = (clip(path, config) for path in clips_below(options.clips))
    rows = [row for kind, runs in kinds.items() for row in _rows(kind, list(runs), options)]
    return {"rows": rows}


def acted(seed: int, elbow: float, config: PuppeteerConfig, arm: int = 0) -> Seen:
    """A person drawn from `seed` raises one arm (0 the right) to each of HEIGHTS."""
    rng = np.random.default_rng(seed)
    person = Person.sample(rng, "held_out", sensor="mocap").still()
    person = replace(person, habits=replace(person.habits, raise_elbow=elbow))
    calm = play(np.zeros((60, sig.NUM)), person, rng, "quiet").clip
    shown = play(sig.of_track(raised(arm)), person, rng, "raised").clip
    puppeteer = Puppeteer(config, calibrate([calm[i] for i in range(0, len(calm), 3)]))
    return _seen(puppeteer, (puppeteer.step(shown[i], stale_command) for i in range(len(shown))))


def clip(path: Path, config: PuppeteerConfig) -> Seen:
    """A real clip, driven to its end."""
    with closing(open_source(spec_of(path))) as source:
        puppeteer = met(source, config)
        return _seen(puppeteer, drive(puppeteer, source, through_falls=True))


def raised(arm: int) -> IntentTrack:
    """One arm up to each of HEIGHTS and down again."""
    each = REST_S + 2.0 * MOVE_S + HOLD_S
    t = np.arange(frames_in(each * len(HEIGHTS) + REST_S)) * sig.DT
    begins = REST_S + each * np.arange(len(HEIGHTS))
    up = (t[:, None] - begins) / MOVE_S
    down = (begins + 2.0 * MOVE_S + HOLD_S - t[:, None]) / MOVE_S
    reach = np.zeros((len(t), 2))
    reach[:, arm] = smoothstep(np.minimum(up, down)) @ np.array(HEIGHTS)
    return make_track("stand", "raised", len(t), reach=reach)


def _seen(puppeteer: Puppeteer, ticks: Iterator[Any]) -> Seen:
    rest = kinematics.foot_pos_b(NEUTRAL["stand"].joint_pos)[:2, 0]
    rows, fell = [], False
    for tick in ticks:
        fell |= tick.fallen
        seen = puppeteer.retargeted
        if tick.state != "stand" or seen is None or seen.features is None:
            continue
        at = dict(zip(INDEX, seen.features.joints, strict=True))
        trunk = [at[f"{s}_shoulder"][2] - at[f"{s}_hip"][2] for s in "rl"]
        if min(trunk) < TRUNK_M:
            continue
        wrist = [(at[f"{s}_wrist"][2] - at[f"{s}_hip"][2]) / h for s, h in zip("rl", trunk)]
        ref, robot = tick.reference, tick.robot
        rows.append(
            [
                *wrist,
                *kinematics.foot_pos_w(ref.base_pos, ref.base_quat, ref.joint_pos)[:2, 2],
                *(kinematics.foot_pos_b(ref.joint_pos)[:2, 0] - rest),
                *kinematics.foot_pos_w(robot.base_pos, robot.base_quat, robot.joint_pos)[:2, 2],
            ]
        )
    wrist, asked, forward, done = np.array(rows).reshape(-1, 4, 2).swapaxes(0, 1)
    return Seen(
        wrist=wrist, asked=asked - FOOT_RADIUS, forward=forward, done=done - FOOT_RADIUS, fell=fell
    )


def _rows(kind: str, runs: list[Seen], options: Options) -> list[dict[str, Any]]:
    wrist, asked, forward, done = (
        np.concatenate([getattr(run, name) for run in runs])
        for name in ("wrist", "asked", "forward", "done")
    )
    high = wrist.argmax(axis=1)
    at = np.arange(len(wrist))
    top, low = wrist.max(axis=1), wrist.min(axis=1)
    alone = low < BINS[0]
    cases: dict[str, NDArray[np.bool_]] = {"both hang": top < BINS[0]}
    for least, most in zip(BINS, (*BINS[1:], np.inf)):
        cases[f"one at {least} to {most}"] = alone & (top >= least) & (top < most)
    cases["both alike, below the shoulders"] = ~alone & (top < 1.0) & (top - low < ALIKE)
    rows = []
    for case, of_case in cases.items():
        if not of_case.any():
            continue
        paw = asked[at, high][of_case]
        rows.append(
            {
                "kind": kind,
                "case": case,
                "controller": options.controller or "policy",
                "seed": options.seed,
                "episodes": len(runs),
                "commit": commit(),
                "frames": int(of_case.sum()),
                "asked_m": float(np.median(paw)),
                "up": float(np.mean(asked[of_case].max(axis=1) > UP_M)),
                "forward_m": float(np.median(forward[at, high][of_case])),
                "done_m": float(np.median(done[at, high][of_case])),
                "fell": sum(run.fell for run in runs),
            }
        )
        log.info("%s", rows[-1])
    return rows
