"""How long the robot stays up: minutes of the whole flow, person after person → time between falls.

Ten-second episodes from a reset cannot see a slow loop: only driving for minutes can. After a fall
the robot is stood up where it lies, as an operator would, and goes on.
"""

import multiprocessing
import os
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chi2

from studio.control.command import PuppeteerConfig
from studio.control.policy import Policy
from studio.control.staleness import stale_command
from studio.control.trackers import PolicyTracker
from studio.errors import StudioError
from studio.evaluation.impaired import IMPAIRMENTS, Impaired
from studio.evaluation.options import TableOptions
from studio.human.calibration import calibrate
from studio.options import ControllerName
from studio.puppeteer import Puppeteer
from studio.reference.intent import STATES
from studio.robot.a1 import CONTROL_DT
from studio.sim import randomize
from studio.synthetic.operator import OperatorSource
from studio.training.machine import commit

Array = NDArray[np.float64]
DynamicsName = Literal["nominal", "table_i"]
FIRST_SEED = 100
"""Operators are drawn from here on."""
LIE_S = 3.0
"""s that a fallen robot lies before it is stood up."""
WINDOW = 60
"""Control periods (2 s) over which the speed asked for and the way made are compared."""
MOVING = 0.05
"""m/s asked for from which a window counts as walking."""
FULL_SPEED = 0.8
"""Share of the speed asked for from which a window of walking counts as walked."""


HOLDS: dict[str, dict[str, float]] = {
    "shipped": {},
    "nothing": {"heading_gain": 0.0, "place_gain": 0.0},
    "heading, within a stride": {"heading_gain": 1.0, "heading_smooth": 0.0, "place_gain": 0.0},
    "heading and place": {"heading_gain": 1.0, "heading_smooth": 0.0, "place_gain": 1.0},
}
"""What the walking policy makes up for: its gains in 1/s, see `ObservationConfig`."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row. source: a spec of the operator. sensor: a name of IMPAIRMENTS. dynamics: those of
    the robot the policies were made for, or draws of Table I. holds: a name of HOLDS."""

    source: str = "operator:walk"
    controller: str = "policy"
    dynamics: DynamicsName = "nominal"
    sensor: str = "mocap"
    holds: str = "shipped"


CASES: tuple[Case, ...] = (
    Case(source="operator:walk"),
    Case(source="operator"),
    Case(source="operator:walk", controller="pd_playback"),
    Case(source="operator", controller="pd_playback"),
    Case(source="operator:walk", holds="nothing"),
    Case(source="operator:walk", holds="heading, within a stride"),
    Case(source="operator:walk", holds="heading and place"),
    Case(source="operator:walk", dynamics="table_i", sensor="dropped"),
    Case(source="operator", dynamics="table_i", sensor="dropped"),
    Case(source="operator:walk", dynamics="table_i", sensor="dropped", controller="pd_playback"),
    Case(source="operator", dynamics="table_i", sensor="dropped", controller="pd_playback"),
    Case(source="operator:walk", sensor="kinect"),
    Case(source="operator", sensor="kinect"),
)


@dataclass(frozen=True, kw_only=True)
class Run:
    """One person's minutes. asked, made: m/s, of each window of walking."""

    seconds: float
    falls: tuple[float, ...]
    asked: tuple[float, ...]
    made: tuple[float, ...]


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate endurance`."""

    episodes: int = 20
    """People who drive, a case."""
    seconds: float = 300.0
    """How long each drives."""
    source: str | None = None
    """Only the cases with this source: operator or operator:walk."""
    controller: ControllerName | None = None
    """Only the cases with this controller."""
    threads: int = 0
    """Processes to use; 0: one a core."""


def run_endurance(options: Options = Options()) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per Case. StudioError where no case is left."""
    cases = [
        case
        for case in CASES
        if options.source in (None, case.source) and options.controller in (None, case.controller)
    ]
    if not cases:
        known = sorted({f"{c.source} by {c.controller}" for c in CASES})
        raise StudioError(f"no such case: choose source and controller of {', '.join(known)}")
    people = [FIRST_SEED + options.seed + k for k in range(options.episodes)]
    jobs = [(case, person, options.seconds) for case in cases for person in people]
    runs = list(_each(jobs, options.threads or os.cpu_count() or 1))
    count = len(people)
    each = [runs[i * count : (i + 1) * count] for i in range(len(cases))]
    return {"rows": [row(case, own, options.seed) for case, own in zip(cases, each, strict=True)]}


def _each(jobs: list[tuple[Case, int, float]], processes: int) -> Iterable[Run]:
    """Runs of the jobs, in their order."""
    if processes <= 1 or len(jobs) == 1:
        return [endure(*job) for job in jobs]
    context = multiprocessing.get_context("spawn")
    with ProcessPoolExecutor(min(processes, len(jobs)), mp_context=context) as pool:
        return list(pool.map(endure, *zip(*jobs, strict=True)))


def endure(case: Case, seed: int, seconds: float) -> Run:
    """One person, drawn from `seed`, drives for `seconds`."""
    source = _source(case, seed)
    puppeteer = Puppeteer(
        PuppeteerConfig(controller=case.controller, seed=seed),
        calibrate(source.calibration_poses()),
    )
    if gains := HOLDS[case.holds]:
        puppeteer.tracker = PolicyTracker(_policies(gains))
    if case.dynamics == "table_i":
        links = int(np.count_nonzero(puppeteer.world.model.body_mass > 0.0))
        drawn = randomize.draw(np.random.default_rng(seed), 1, links)
        puppeteer.world.set_dynamics(drawn)
        puppeteer.reset()
    falls: list[float] = []
    lying, age = 0.0, np.inf
    rows: list[tuple[bool, float, Array]] = []
    for k in range(round(seconds / CONTROL_DT)):
        human = source.read(k * CONTROL_DT)
        age = 0.0 if human is not None else age + CONTROL_DT
        if lying > 0.0:
            lying -= CONTROL_DT
            if lying <= 0.0:
                puppeteer.stand_up()
                puppeteer.rejoin()
            continue
        tick = puppeteer.step(human, stale_command(float(age)))
        if tick.fallen:
            falls.append(k * CONTROL_DT)
            lying = LIE_S
        speed = float(np.hypot(*tick.reference.base_lin_vel_w[:2]))
        rows.append((tick.state == "walk" and not tick.fallen, speed, tick.robot.base_pos[:2]))
    asked, made = _windows(rows)
    return Run(seconds=seconds, falls=tuple(falls), asked=asked, made=made)


def _source(case: Case, seed: int) -> Impaired:
    impairment = IMPAIRMENTS[case.sensor]
    task = case.source.partition(":")[2] or None
    operator = OperatorSource(task, seed=seed, sensor=impairment.sensor)
    return Impaired(operator, impairment, seed)


def _policies(gains: dict[str, Any]) -> dict[Any, Policy]:
    """The shipped policies, walking with other corrections of its way."""
    policies = {state: Policy.load(state) for state in STATES}
    walk = policies["walk"]
    policies["walk"] = walk.observing(replace(walk.observation, **gains))
    return policies


def _windows(rows: list[tuple[bool, float, Array]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Mean speed asked for, and way made along it per second, in windows spent walking."""
    asked, made = [], []
    for first in range(0, len(rows) - WINDOW, WINDOW):
        window = rows[first : first + WINDOW + 1]
        wanted = float(np.mean([speed for _, speed, _ in window]))
        if all(walks for walks, _, _ in window) and wanted > MOVING:
            way = np.diff([place for *_, place in window], axis=0)
            # Half a second at a time: a curve is no shortcut, wobble within a stride no way.
            steps = [np.linalg.norm(way[i : i + 15].sum(axis=0)) for i in range(0, WINDOW, 15)]
            asked.append(wanted)
            made.append(float(np.sum(steps)) / (WINDOW * CONTROL_DT))
    return tuple(asked), tuple(made)


def row(case: Case, runs: list[Run], seed: int) -> dict[str, Any]:
    """Falls, and mean time between them with a 95 % interval (Poisson, exact).

    Time counts that was not spent lying. walking_s: in windows of walking at FULL_SPEED or more of
    the speed asked for.
    """
    asked = np.array([a for run in runs for a in run.asked])
    made = np.array([m for run in runs for m in run.made])
    falls = sum(len(run.falls) for run in runs)
    up = sum(run.seconds for run in runs) - LIE_S * falls
    walking = float(np.count_nonzero(made >= FULL_SPEED * asked)) * WINDOW * CONTROL_DT
    low, high = time_between(falls, up)
    return {
        "case": case.source,
        "source": case.source,
        "controller": case.controller,
        "dynamics": case.dynamics,
        "sensor": case.sensor,
        "holds": case.holds,
        "seed": seed,
        "episodes": len(runs),
        "seconds_each": runs[0].seconds,
        "commit": commit(),
        "falls": falls,
        "first_falls_s": [round(run.falls[0], 1) for run in runs if run.falls],
        "seconds": up,
        "walking_s": walking,
        "mean_time_between_falls_s": up / falls if falls else None,
        "mean_time_between_falls_s_ci": [low, high],
        "speed_asked_m_s": float(asked.mean()) if len(asked) else 0.0,
        "speed_made_m_s": float(made.mean()) if len(made) else 0.0,
    }


def time_between(falls: int, seconds: float) -> tuple[float, float | None]:
    """95 % interval, s, of the mean time between falls; no upper end where none was seen."""
    low = 2.0 * seconds / chi2.ppf(0.975, 2 * falls + 2)
    high = 2.0 * seconds / chi2.ppf(0.025, 2 * falls) if falls else None
    return float(low), None if high is None else float(high)
