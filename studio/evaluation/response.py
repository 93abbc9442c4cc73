"""How late the robot does what a person does, stage by stage: person, features, mapper, reference,
robot.

Synthetic people who make one sudden movement after another, and hands raised in real clips
(`--clips`). Lag: of the whole movement, by cross-correlation with the person. Onset: of its
beginning, by a threshold.
"""

import logging
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import statistics
from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation.clips import clips_below
from studio.evaluation.lateness import lag_s, onset_s
from studio.evaluation.options import TableOptions
from studio.evaluation.response_signals import GESTURES, STAGES, STEPPING, signals, track_of
from studio.human.calibration import calibrate
from studio.human.pose import HumanPose
from studio.mocap.source import Source, SourceEnded
from studio.options import ControllerName
from studio.puppeteer import Puppeteer
from studio.reference.marching import march_track
from studio.retarget.mapper import Mapped
from studio.retarget.settings import joint_speed
from studio.robot.a1 import CONTROL_DT
from studio.sources import open_source, spec_of
from studio.synthetic.perform import perform
from studio.synthetic.person import Person
from studio.timing import PAPER_JOINT_SPEED_DEG
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

MOVING = 0.02
"""Share of a signal's range in one period from which the person counts as moving."""
HANDS, HAND_M = ("right hand", "left hand"), 0.3
"""In clips; m by which one has to move for the clip to count."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate response`."""

    clips: Path | None = None
    """Folder of real motion clips, for the hands raised in them; folders below count."""
    episodes: int = 8
    """Synthetic people a movement."""
    controller: ControllerName | None = None
    """What turns the reference into an action (default: policy once trained)."""
    max_joint_speed: float = PAPER_JOINT_SPEED_DEG
    """Degrees a second, as of `drive`."""


@dataclass(frozen=True, kw_only=True)
class Followed:
    """One person. signals: (T,) by stage. begins: s at which movements begin (none: not known).
    clipped: share of the periods in which the person moves that the speed limit cut."""

    signals: dict[str, Array]
    begins: Array
    clipped: float
    fell: bool


def run_response(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}`: one per movement and stage, of synthetic people, then of real hands.

    behind_ms, onset_ms: medians over the people, with 95 % bootstrap intervals; behind_ms None
    where no course over time can be told from the next one's (steps). followed: share of the people
    whose movement the stage did at all.
    """
    quick = joint_speed(options.max_joint_speed)
    config = PuppeteerConfig(controller=options.controller, seed=options.seed, joint_speed=quick)
    rows = []
    for name in GESTURES:
        seeds = range(options.seed, options.seed + options.episodes)
        rows += _rows(name, "synthetic", [_acted(name, seed, config) for seed in seeds], options)
    if options.clips is not None:
        clips = [_clip(path, config) for path in clips_below(options.clips)]
        hands = [hand for clip in clips for hand in clip]
        rows += _rows("raised hand", "real", hands, options) if hands else []
    for row in rows:
        log.info("%s", row)
    return {"rows": rows}


@dataclass
class _Noted:
    """Signals of each stage so far, of several movements at once."""

    rows: dict[str, list[list[float]]] = field(default_factory=dict)
    clipped: list[bool] = field(default_factory=list)
    fell: bool = False


def _follow(
    names: Iterable[str],
    read: Callable[[float], HumanPose | None],
    calm: list[HumanPose],
    config: PuppeteerConfig,
    seconds: float,
) -> _Noted:
    """Drive what is read through the whole flow."""
    puppeteer = Puppeteer(config, calibrate(calm))
    noted = _Noted({name: [] for name in names})
    said: Mapped | None = None
    for k in range(round(seconds / CONTROL_DT)):
        try:
            pose = read(k * CONTROL_DT)
        except SourceEnded:
            break
        tick = puppeteer.step(pose, stale_command)
        seen = puppeteer.retargeted
        assert seen is not None
        said = seen.mapped or said  # on a way between states no expert is asked
        if tick.human is None or seen.features is None or said is None:
            continue
        noted.fell |= tick.fallen
        noted.clipped.append(tick.clipped)
        for name, rows in noted.rows.items():
            rows.append(signals(name, tick.human, seen.features, said, tick))
    return noted


def _followed(noted: _Noted, name: str, begins: Array) -> Followed:
    by_stage = np.array(noted.rows[name]).T
    person = by_stage[0]
    moving = np.abs(np.gradient(person)) > MOVING * np.ptp(person)
    clipped = np.array(noted.clipped)
    return Followed(
        signals=dict(zip(STAGES, by_stage)),
        begins=begins,
        clipped=float(clipped[moving].mean()) if moving.any() else 0.0,
        fell=noted.fell,
    )


def _acted(name: str, seed: int, config: PuppeteerConfig) -> Followed:
    """A person drawn from `seed` makes the movement again and again."""
    rng = np.random.default_rng([seed, 31])
    person = Person.sample(rng, sensor="mocap")
    calm = perform(march_track("quiet", 3.0, []), person.still(), rng)
    track, begins = track_of(name)
    clip = perform(track, person, rng)
    noted = _follow(
        [name],
        lambda t: clip[round(t / CONTROL_DT)],
        [calm[i] for i in range(0, len(calm), 3)],
        config,
        len(clip) * CONTROL_DT,
    )
    return _followed(noted, name, begins)


def _clip(path: Path, config: PuppeteerConfig) -> list[Followed]:
    """Both hands of a real clip, as far as they move."""
    source: Source = open_source(spec_of(path))
    try:
        calm = source.calibration_poses()
        noted = _follow(HANDS, source.read, calm, config, source.duration or 60.0)
    finally:
        source.close()
    hands = [_followed(noted, name, np.zeros(0)) for name in HANDS if noted.rows[name]]
    return [hand for hand in hands if np.ptp(hand.signals["person"]) > HAND_M]


def _rows(name: str, kind: str, people: list[Followed], options: Options) -> list[dict[str, Any]]:
    rows = []
    for stage in STAGES[1:]:
        lags = [lag_s(each.signals["person"], each.signals[stage]) for each in people]
        onsets = [
            late
            for each in people
            for begin in each.begins
            if (late := _late(each, stage, float(begin))) is not None
        ]
        found = [lag for lag in lags if lag is not None]
        rows.append(
            {
                "case": name,
                "kind": kind,
                "stage": stage,
                "max_joint_speed_deg_s": options.max_joint_speed,
                "controller": options.controller or "policy",
                "seed": options.seed,
                "episodes": len(people),
                "commit": commit(),
                "followed": None if name in STEPPING else len(found) / len(people),
                **_median("behind_ms", [] if name in STEPPING else found),
                **_median("onset_ms", onsets),
                "clipped": float(np.mean([each.clipped for each in people])),
                "fell": sum(each.fell for each in people),
            }
        )
    return rows


def _late(each: Followed, stage: str, begin: float) -> float | None:
    person = onset_s(each.signals["person"], begin)
    other = None if person is None else onset_s(each.signals[stage], begin)
    return None if person is None or other is None else other - person


def _median(name: str, values: list[float]) -> dict[str, Any]:
    if not values:
        return {name: None, f"{name}_ci": None}
    ms = 1000.0 * np.array(values)
    ends = statistics.bootstrap_ci(ms, lambda x: float(np.median(x)))
    return {name: float(np.median(ms)), f"{name}_ci": list(ends)}
