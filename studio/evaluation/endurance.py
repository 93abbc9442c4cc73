"""How long the robot stays up: minutes of the whole flow, person after person → time between falls.

Ten-second episodes from a reset cannot see a slow loop: only driving for minutes can.
"""

import logging
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
from scipy.stats import chi2

from studio.errors import StudioError
from studio.evaluation.kept_runs import file_of, kept_runs
from studio.evaluation.long_drive import LIE_S, WINDOW, Case, Run, endure
from studio.evaluation.options import TableOptions
from studio.evaluation.tracking import CACHE
from studio.options import ControllerName
from studio.retarget.settings import joint_speed
from studio.robot.a1 import CONTROL_DT
from studio.synthetic.impaired import BRISK, TRAVELLER
from studio.training.machine import commit

log = logging.getLogger(__name__)
FIRST_SEED = 100
"""Operators are drawn from here on."""
FULL_SPEED = 0.8
"""Share of the speed asked for from which a window of walking counts as walked."""
WALK, TOUR = "operator:walk", "operator"
CASES: tuple[Case, ...] = (
    Case(source=WALK),
    Case(source=TOUR),
    Case(source=BRISK, people=200, seconds=30.0),
    Case(source=TRAVELLER),
    Case(source=WALK, dynamics="table_i", sensor="dropped"),
    Case(source=TOUR, dynamics="table_i", sensor="dropped"),
    Case(source=WALK, sensor="kinect"),
    Case(source=TOUR, sensor="kinect"),
    Case(source=WALK, controller="pd_playback"),
    Case(source=TOUR, controller="pd_playback"),
    Case(source=WALK, dynamics="table_i", sensor="dropped", controller="pd_playback"),
    Case(source=TOUR, dynamics="table_i", sensor="dropped", controller="pd_playback"),
    Case(source=WALK, steps="generated"),
    Case(source=TOUR, steps="generated"),
    Case(source=WALK, dynamics="table_i", sensor="dropped", steps="generated"),
    Case(source=TOUR, dynamics="table_i", sensor="dropped", steps="generated"),
    Case(source=WALK, holds="nothing"),
    Case(source=WALK, holds="heading, within a stride"),
)
_FLOW = (
    "control", "human", "mocap", "reference", "retarget", "rl/noise", "robot", "scenes", "sim",
    "synthetic", "geometry", "rhythm", "timing", "metrics", "puppeteer", "link/link", "link/sim",
    "evaluation/behind", "evaluation/long_drive",
)  # fmt: skip
"""What a run depends on, beside the models."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate endurance`."""

    episodes: int | None = None
    """People who drive, a case (default: each case's own, 20 or 200)."""
    seconds: float | None = None
    """How long each drives (default: each case's own, 300 or 30)."""
    source: str | None = None
    """Only the cases with this source: operator, operator:walk, brisk or travel."""
    controller: ControllerName | None = None
    """Only the cases with this controller."""
    max_joint_speed: float | None = None
    """Degrees a second that standing and sitting references' joints may reach (default: the
    paper's 120)."""
    threads: int = 0
    """Processes to use; 0: one a core."""


def run_endurance(options: Options = Options(), *, cache: Path | None = CACHE) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per Case. StudioError where no case is left.

    Each person's run is kept in `cache`: a table that was cut off goes on where it stopped.
    """
    given = {
        "people": options.episodes,
        "seconds": options.seconds,
        "max_joint_speed": options.max_joint_speed,
    }
    changed = {name: value for name, value in given.items() if value is not None}
    cases = [
        replace(case, **changed)
        for case in CASES
        if options.source in (None, case.source) and options.controller in (None, case.controller)
    ]
    if options.max_joint_speed is not None:
        joint_speed(options.max_joint_speed)  # says what is out of its range
    if not cases:
        known = sorted({f"{c.source} by {c.controller}" for c in CASES})
        raise StudioError(f"no such case: choose source and controller of {', '.join(known)}")
    jobs = [(case, FIRST_SEED + options.seed + k) for case in cases for k in range(case.people)]
    keys = [[{**asdict(case), "people": None}, seed] for case, seed in jobs]
    files = [file_of(cache, "endure", _FLOW, key) for key in keys]
    runs = kept_runs(_run, Run, jobs, files, options.threads)
    rows = []
    for case in cases:
        rows.append(row(case, [next(runs) for _ in range(case.people)], options.seed))
        log.info("%s", rows[-1])
    return {"rows": rows}


def _run(job: tuple[Case, int]) -> Run:
    return endure(*job)


def row(case: Case, runs: list[Run], seed: int) -> dict[str, Any]:
    """Falls, how many an hour and the mean time between them, with 95 % intervals (Poisson, exact).

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
        "steps": case.steps,
        "max_joint_speed_deg_s": case.max_joint_speed,
        "goal": goal(case),
        "seed": seed,
        "episodes": len(runs),
        "seconds_each": runs[0].seconds,
        "commit": commit(),
        "falls": falls,
        "first_falls_s": [round(run.falls[0], 1) for run in runs if run.falls],
        "seconds": up,
        "walking_s": walking,
        "falls_per_hour": 3600.0 * falls / up,
        "falls_per_hour_ci": [0.0 if high is None else 3600.0 / high, 3600.0 / low],
        "mean_time_between_falls_s": up / falls if falls else None,
        "mean_time_between_falls_s_ci": [low, high],
        "speed_asked_m_s": float(asked.mean()) if len(asked) else 0.0,
        "speed_made_m_s": float(made.mean()) if len(made) else 0.0,
    }


def goal(case: Case) -> float | None:
    """Most falls an hour that the shipped policy may have; None: for comparison only."""
    shipped = (case.controller, case.holds, case.steps) == ("policy", "shipped", "mapped")
    if not shipped or case.sensor == "kinect":
        return None
    return 0.0 if case.dynamics == "nominal" else 1.0


def time_between(falls: int, seconds: float) -> tuple[float, float | None]:
    """95 % interval, s, of the mean time between falls; no upper end where none was seen."""
    low = 2.0 * seconds / chi2.ppf(0.975, 2 * falls + 2)
    high = 2.0 * seconds / chi2.ppf(0.025, 2 * falls) if falls else None
    return float(low), None if high is None else float(high)
