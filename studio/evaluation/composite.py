"""Composite tasks: who completes the scenes, step by step, with a person's motion alone.

A scripted operator (`scene_operator`) sees each scene as the page shows it, or as the robot's own
camera does (`scene_views`), and means what the next step needs; a synthetic person whom no mapper
has seen acts that out; their motion drives the robot.
"""

import logging
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Annotated, Any

import numpy as np
import tyro
from scipy.stats import beta

from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.evaluation.kept_runs import file_of, kept_runs
from studio.evaluation.options import TableOptions
from studio.evaluation.scene_operator import ScriptedOperator
from studio.evaluation.scene_plays import PLAYS
from studio.evaluation.scene_views import View, eyes_of
from studio.evaluation.tracking import CACHE, names_of
from studio.human.calibration import Calibration, calibrate
from studio.human.pose import HumanPose
from studio.options import Style
from studio.puppeteer import Puppeteer
from studio.robot.a1 import CONTROL_DT
from studio.synthetic.operator import InteractiveOperator
from studio.synthetic.person import HELD_OUT_SEED
from studio.takes.record.codec import decode, encode
from studio.takes.tick import Tick
from studio.training.machine import commit

log = logging.getLogger(__name__)
COMPARED = ("policy", "pd_playback", "stand_still")
GOAL, WITH_GOAL = 0.95, ("greeting", "hardware", "push", "slalom")
"""Share of the policy's runs to complete, of these scenes."""
_OVERTIME = 5.0
"""s beyond a step's own time after which nobody waits for it any more, the clock running or not."""
_FLOW = (
    "control", "human", "mocap", "reference", "retarget", "robot", "scenes", "sim", "synthetic",
    "geometry", "rhythm", "timing", "metrics", "puppeteer", "sources", "takes/record", "takes/tick",
    "link/link", "link/sim", "evaluation/composite", "evaluation/scene_operator",
    "evaluation/scene_plays", "evaluation/scene_views", "evaluation/scene_ways",
)  # fmt: skip
"""What a run depends on, beside the models."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate composite`."""

    scenes: tuple[str, ...] = tuple(PLAYS)
    """Which scenes."""
    episodes: Annotated[int, tyro.conf.arg(aliases=["--seeds"])] = 20
    """People who try each scene, each with a seed of their own."""
    controllers: tuple[str, ...] = COMPARED
    """Which controllers."""
    view: tuple[View, ...] = ("third_person",)
    """What the operator sees: robot and props from outside, what the robot's own camera sees, or
    that and the robot's measured state."""
    style: Style = "march"
    """Which human motion means walking."""
    threads: int = 0
    """Processes to use; 0: one a core."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """One person's attempt at one scene."""

    scene: str
    controller: str
    style: str
    seed: int
    view: View = "third_person"


@dataclass(frozen=True, kw_only=True)
class Run:
    """What came of it. done: s on the scene's clock of each step that was done; failed: why it
    ended, "" once finished; seconds: that it took, the clock running or not."""

    steps: tuple[str, ...]
    done: tuple[float, ...]
    score: int
    failed: str
    seconds: float


def run_composite(options: Options = Options(), *, cache: Path | None = CACHE) -> dict[str, Any]:
    """`{"rows": [...]}`: for each scene, controller and view a row of all runs (`step` "all"), and
    one a person and step. Attempts are kept in `cache`: a table that was cut off goes on.
    StudioError for an unknown scene or controller."""
    scenes = names_of("scene", options.scenes, tuple(PLAYS))
    chosen = names_of("controller", options.controllers, COMPARED)
    seeds = range(options.seed, options.seed + options.episodes)
    groups = [
        [Job(scene=s, controller=c, style=options.style, seed=k, view=v) for k in seeds]
        for s in scenes
        for c in chosen
        for v in options.view
    ]
    jobs = [job for group in groups for job in group]
    files = [file_of(cache, "composite", _FLOW, asdict(job)) for job in jobs]
    runs = kept_runs(attempt, Run, jobs, files, options.threads)
    rows = []
    for group in groups:
        made = [next(runs) for _ in group]
        rows.append(_whole(group, made))
        log.info("%s", rows[-1])
        rows += [row for job, run in zip(group, made, strict=True) for row in _steps(job, run)]
    return {"rows": rows}


def attempt(job: Job, on_tick: Callable[[Tick], None] | None = None) -> Run:
    """One person tries. All that the puppeteer is given is what a sensor saw of them, to the
    micrometre that a tape keeps: whoever plays a recorded attempt again has the same run."""
    return act_out(job, puppeteer_of(job), on_tick)


def act_out(job: Job, puppeteer: Puppeteer, on_tick: Callable[[Tick], None] | None = None) -> Run:
    """As `attempt`, with this puppeteer, which is in the job's scene."""
    person = person_of(job)
    eyes = eyes_of(job.view, puppeteer.stage, np.random.default_rng([job.seed, 17]))
    operator = ScriptedOperator(PLAYS[job.scene], eyes.doubt)

    def motion(k: int) -> HumanPose | None:
        person.set_intent(operator.mean(eyes.see(operator.meant)))
        pose = person.read(k * CONTROL_DT)
        return None if pose is None else decode("human", encode("human", pose))

    return play(puppeteer, motion, on_tick)


def person_of(job: Job) -> InteractiveOperator:
    """Somebody of their own for each seed, whom no mapper was trained on."""
    return InteractiveOperator(seed=HELD_OUT_SEED + job.seed, style=job.style)


def calibration_of(job: Job) -> Calibration:
    """Of that person, standing quietly before they begin."""
    return calibrate(person_of(job).calibration_poses())


def puppeteer_of(job: Job) -> Puppeteer:
    """The flow, in the job's scene."""
    return Puppeteer(
        PuppeteerConfig(style=job.style, controller=job.controller, seed=job.seed, scene=job.scene),
        calibration_of(job),
    )


def play(
    puppeteer: Puppeteer,
    motion: Callable[[int], HumanPose | None],
    on_tick: Callable[[Tick], None] | None = None,
) -> Run:
    """Drive with what was seen of a person in each period until the scene is finished or failed."""
    stage, k, since, done = puppeteer.stage, 0, 0.0, 0
    while not stage.finished and stage.failed is None:
        step = stage.step_now
        assert step is not None
        if since > step.within + _OVERTIME:
            break
        tick = puppeteer.step(motion(k), stale_command)
        if on_tick is not None:
            on_tick(tick)
        since = since + CONTROL_DT if len(stage.done) == done else 0.0
        k, done = k + 1, len(stage.done)
    return Run(
        steps=tuple(step.name for step in stage.scene.steps),
        done=tuple(round(each.t, 2) for each in stage.done),
        score=stage.progress()["score"],
        failed="" if stage.finished else stage.failed or "nothing happened",
        seconds=round(k * CONTROL_DT, 2),
    )


def share_ci(k: int, n: int) -> tuple[float, float]:
    """95 % interval (Clopper and Pearson) of a share of which k of n were seen."""
    low = float(beta.ppf(0.025, k, n - k + 1)) if k else 0.0
    high = float(beta.ppf(0.975, k + 1, n - k)) if k < n else 1.0
    return low, high


def _row(job: Job, step: str, episodes: int) -> dict[str, Any]:
    return {
        "case": job.scene,
        "step": step,
        "controller": job.controller,
        "view": job.view,
        "style": job.style,
        "seed": job.seed,
        "episodes": episodes,
        "commit": commit(),
    }


def _whole(group: Sequence[Job], runs: Sequence[Run]) -> dict[str, Any]:
    """All runs of one scene and controller. seconds: the median of those that were completed."""
    job, n = group[0], len(runs)
    times = [run.done[-1] for run in runs if not run.failed]
    reasons = [run.failed for run in runs if run.failed]
    steps = runs[0].steps
    of_goal = job.controller == "policy" and job.view == "third_person"
    return {
        **_row(job, "all", n),
        "goal": GOAL if job.scene in WITH_GOAL and of_goal else None,
        "done": len(times) / n,
        "done_ci": share_ci(len(times), n),
        "seconds": float(np.median(times)) if times else None,
        "score": float(np.mean([run.score for run in runs])),
        "steps_done": {
            name: sum(len(r.done) > i for r in runs) / n for i, name in enumerate(steps)
        },
        "failed": {why: reasons.count(why) for why in sorted(set(reasons))},
    }


def _steps(job: Job, run: Run) -> Iterator[dict[str, Any]]:
    """seconds: on the scene's clock, from the step before."""
    before = 0.0
    for i, name in enumerate(run.steps):
        at = run.done[i] if i < len(run.done) else None
        yield {
            **_row(job, name, 1),
            "done": at is not None,
            "seconds": None if at is None else round(at - before, 2),
            "failed": run.failed if i == len(run.done) else "",
        }
        before = before if at is None else at
