"""What a link bears: tracking, falls and scenes over a line that delays, jitters and loses.

The whole flow drives; the robot's side is the one of `a1-studio robot`, datagrams and watchdog
included, on simulated time. `references` is what the link is for; `targets` shows why.
"""

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from studio import metrics
from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.errors import StudioError
from studio.evaluation.behind import met
from studio.evaluation.composite import Job as SceneJob
from studio.evaluation.composite import act_out, calibration_of, share_ci
from studio.evaluation.kept_runs import file_of, kept_runs
from studio.evaluation.options import TableOptions
from studio.evaluation.tracking import CACHE
from studio.link.link import Level
from studio.link.simulated import Line, SimulatedLink
from studio.puppeteer import Puppeteer
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose
from studio.synthetic.operator import OperatorSource
from studio.takes.tick import Tick
from studio.training.machine import commit

log = logging.getLogger(__name__)
C = TypeVar("C")
FIRST_SEED = 100
TOUR = "tour"
MOST_LAG = 30
"""Control periods (1 s) among which the robot's lag is looked for."""
SCENES = ("greeting", "push")
_FLOW = (
    "control", "human", "link", "mocap", "reference", "retarget", "robot", "scenes", "sim",
    "synthetic", "geometry", "rhythm", "timing", "metrics", "puppeteer", "evaluation/behind",
    "evaluation/composite", "evaluation/link", "evaluation/scene_operator",
    "evaluation/scene_plays", "evaluation/scene_views", "evaluation/scene_ways",
)  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row. delay_ms, jitter_ms, loss: of each way. task: TOUR, of every state, or a scene."""

    level: Level
    delay_ms: float = 0.0
    jitter_ms: float = 0.0
    loss: float = 0.0
    task: str = TOUR


CASES: tuple[Case, ...] = (
    *(Case(level="targets", delay_ms=d) for d in (0.0, 10.0, 20.0, 30.0, 40.0, 60.0, 80.0, 100.0)),
    Case(level="targets", loss=0.1),
    *(Case(level="references", delay_ms=d) for d in (0.0, 50.0, 100.0, 200.0, 300.0)),
    Case(level="references", loss=0.1),
    Case(level="references", delay_ms=100.0, jitter_ms=50.0, loss=0.05),
    *(
        Case(level="references", delay_ms=300.0, jitter_ms=50.0, loss=0.1, task=task)
        for task in (TOUR, *SCENES)
    ),
    *(Case(level="references", task=scene) for scene in SCENES),
)


@dataclass(frozen=True, kw_only=True)
class PeopleOptions(TableOptions):
    """Of a table whose rows are people who drive over a link."""

    episodes: int = 5
    """People who drive, a row."""
    seconds: float = 40.0
    """How long each drives; a tour of every task takes 40 s."""
    threads: int = 0
    """Processes to use; 0: one a core."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 1.0 <= self.seconds <= 3600.0:
            raise StudioError(f"--seconds must be 1 to 3600, not {self.seconds}")


@dataclass(frozen=True, kw_only=True)
class Options(PeopleOptions):
    """Of `evaluate link`."""

    level: Level | None = None
    """Only this level."""


@dataclass(frozen=True, kw_only=True)
class Run:
    """One person's drive. seconds: until it ended; fell: by a fall. done: of a scene, completed.
    lag: control periods. joint_ms: rad², of the robot against its reference a lag ago. idle: share
    of the time in which the robot's side followed nobody."""

    seconds: float
    fell: bool
    done: bool
    lag: int
    joint_ms: float
    tilt: float
    idle: float


def run_link(options: Options = Options(), *, cache: Path | None = CACHE) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per Case; each person's run is kept in `cache`."""
    cases = [case for case in CASES if options.level in (None, case.level)]
    made = runs_of("link", _FLOW, drive_over, cases, options, cache)
    return {"rows": [row(case, runs, options) for case, runs in made]}


def runs_of(
    name: str,
    code: Sequence[str],
    drive: Callable[[C, float, int], Run],
    cases: Sequence[C],
    options: PeopleOptions,
    cache: Path | None,
) -> Iterator[tuple[C, list[Run]]]:
    """Each case (a dataclass) with its people's runs, each kept in `cache` under `name`.

    drive: a function of a module, (case, seconds, seed). code: what a run depends on (`file_of`).
    """
    seeds = [FIRST_SEED + options.seed + k for k in range(options.episodes)]
    jobs = [(case, options.seconds, seed) for case in cases for seed in seeds]
    files = [
        file_of(cache, name, code, [asdict(case), *rest])  # type: ignore[call-overload]
        for case, *rest in jobs
    ]
    runs = kept_runs(partial(_spread, drive), Run, jobs, files, options.threads)
    for case in cases:
        made = [next(runs) for _ in seeds]
        log.info("%s: %d falls", case, sum(run.fell for run in made))
        yield case, made


def _spread(drive: Callable[[C, float, int], Run], job: tuple[C, float, int]) -> Run:
    return drive(*job)


def drive_over(case: Case, seconds: float, seed: int) -> Run:
    """One person, drawn from `seed`, drives over the case's line."""
    line = Line(delay=1e-3 * case.delay_ms, jitter=1e-3 * case.jitter_ms, loss=case.loss)
    link = SimulatedLink(line, case.level, seed)
    if case.task == TOUR:
        return toured(link, OperatorSource(seed=seed), seconds, seed)
    job = SceneJob(scene=case.task, controller="policy", style="march", seed=seed)
    puppeteer = Puppeteer(
        PuppeteerConfig(scene=case.task, seed=seed), calibration_of(job), link=link
    )
    seen = _Seen(link)
    made = act_out(job, puppeteer, seen.add)
    return seen.run(made.seconds, fell=made.failed == "the robot fell", done=not made.failed)


def toured(link: SimulatedLink, source: OperatorSource, seconds: float, seed: int) -> Run:
    """What came of `source` driving the link's robot for so long, or until it lies."""
    puppeteer, seen = met(source, PuppeteerConfig(seed=seed), link), _Seen(link)
    for k in range(round(seconds / CONTROL_DT)):
        tick = puppeteer.step(source.read(k * CONTROL_DT), stale_command)
        if seen.see(tick.reference):
            return seen.run((k + 1) * CONTROL_DT, fell=True, done=False)
    return seen.run(seconds, fell=False, done=False)


class _Seen:
    """What a table needs of each period, of the robot itself: no line between."""

    def __init__(self, link: SimulatedLink) -> None:
        self._link = link
        self._robot, self._reference, self._up, self._asked = [], [], [], []
        self._follows: list[bool] = []

    def see(self, reference: ReferencePose) -> bool:
        """One more period; whether the robot lies."""
        robot, side = self._link.engine.state(), self._link.side
        self._robot.append(robot.joint_pos)
        self._reference.append(reference.joint_pos)
        self._up.append(robot.base_quat)
        self._asked.append(reference.base_quat)
        self._follows.append(side.phase in ("following", "holding"))
        return robot.trunk_contact or side.phase == "limp"

    def add(self, tick: Tick) -> None:
        """As `see`."""
        self.see(tick.reference)

    def run(self, seconds: float, *, fell: bool, done: bool) -> Run:
        """All that was seen."""
        robot, reference = np.array(self._robot), np.array(self._reference)
        most = min(MOST_LAG, len(robot) // 2)
        lag = metrics.lag_periods(robot, reference, most)
        end = len(robot) - lag
        tilt = metrics.orientation_error(np.array(self._up)[lag:], np.array(self._asked)[:end])
        return Run(
            seconds=seconds,
            fell=fell,
            done=done,
            lag=int(lag),
            joint_ms=float(np.mean(metrics.joint_error_sq(robot[lag:], reference[:end]))),
            tilt=float(np.mean(tilt)),
            idle=1.0 - float(np.mean(self._follows)),
        )


def row(case: Case, runs: list[Run], options: Options) -> dict[str, Any]:
    """Means over people; errors against the reference that was sent `lag_ms` before. A scene has
    `done`, the share that completed it, with a 95 % interval (Clopper and Pearson)."""
    n, scene = len(runs), case.task != TOUR
    done = sum(run.done for run in runs)
    survived = [1.0 if not r.fell else r.seconds / options.seconds for r in runs]
    return {
        "case": f"{case.level}, {case.task}",
        "controller": "policy",
        **asdict(case),
        "seed": options.seed,
        "episodes": n,
        "commit": commit(),
        "falls": sum(run.fell for run in runs),
        "success_time_ratio": None if scene else float(np.mean(survived)),
        "done": done / n if scene else None,
        "done_ci": share_ci(done, n) if scene else None,
        "seconds": float(np.mean([run.seconds for run in runs])),
        "lag_ms": 1e3 * CONTROL_DT * float(np.mean([run.lag for run in runs])),
        "joint_rmse_deg": metrics.rms_deg(float(np.mean([run.joint_ms for run in runs]))),
        "orientation_error_deg": float(np.degrees(np.mean([run.tilt for run in runs]))),
        "not_following_share": float(np.mean([run.idle for run in runs])),
    }
