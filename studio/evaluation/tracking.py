"""How well references are tracked under Table I: stand still, PD playback and the policies.

Success time alone can be gamed (standing still never falls), so the tracked-time ratio and the
errors stand beside it. Every controller meets the same references, dynamics and noise.
"""

import hashlib
import logging
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress

from studio.control.policy import MODELS
from studio.errors import unknown_name
from studio.evaluation.contenders import CONTENDERS, Contender, contender
from studio.evaluation.options import PolicyOptions, refuse_none
from studio.files import fingerprint
from studio.metrics import rms_deg
from studio.reference.intent import STATES, StateName
from studio.reference.library import task_names
from studio.rl import rollouts
from studio.rl.bank import MotionBank
from studio.rl.bank_store import library_bank, save_arrays
from studio.statistics import bootstrap_ci
from studio.training.machine import commit

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

CHUNK = 256
"""Episodes simulated side by side; what is cached and resumed."""
HELD_OUT = 10_000
"""Added to the seed of the motions: training's banks use seeds below it."""
CACHE = Path("runs/evaluate")
Job = tuple[StateName, Contender]
Motions = Callable[[StateName, int, int, Path | None], MotionBank]

# Name in a row: (figure of an episode, from the mean to the row's unit).
_FIGURES: dict[str, tuple[str, Callable[[float], float]]] = {
    "success_time_ratio": ("success_time", float),
    "tracked_time_ratio": ("tracked_time", float),
    "joint_rmse_deg": ("joint_ms", rms_deg),
    "foot_error_m": ("foot_error", float),
    "orientation_error_deg": ("tilt_error", lambda x: float(np.rad2deg(x))),
    "height_error_m": ("height_error", float),
    "velocity_error_m_s": ("velocity_error", float),
    "yaw_rate_error_deg_s": ("yaw_rate_error", lambda x: float(np.rad2deg(x))),
    "lag_ms": ("lag", lambda x: 1000.0 * x),
    "drift_m": ("drift", float),
    "path_m": ("path", float),
    "foot_skate_m_s": ("skate", float),
    "jerk_rad_s3": ("jerk", float),
    "torque_saturation": ("saturation", float),
}


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate tracking`."""

    states: tuple[StateName, ...] = STATES
    """Which experts."""
    controllers: tuple[str, ...] = CONTENDERS
    """Which controllers; a policy that is not trained has no row."""


def run_tracking(
    options: Options = Options(),
    *,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per state and controller, each figure with its 95 % `*_ci`.

    Rows of policies that are not trained are left out. Chunks of episodes are kept in `cache`: a
    run that was cut off goes on where it stopped. StudioError for unknown names.
    """
    wanted = cast(list[StateName], names_of("state", options.states, STATES))
    chosen = names_of("controller", options.controllers, CONTENDERS)
    present: list[Job] = []
    for state in wanted:
        for name in chosen:
            if who := contender(name, state, models):
                present.append((state, who))
    rows = compare(present, options.episodes, options.seed, options.threads, cache, progress)
    return {"rows": rows}


def compare(
    jobs: Sequence[Job],
    episodes: int,
    seed: int,
    threads: int = 0,
    cache: Path | None = CACHE,
    progress: bool = True,
    motions: Motions | None = None,
) -> list[dict[str, Any]]:
    """A row for each state and contender, on the same held-out motions, dynamics and noise.

    motions: draws a chunk's bank from (state, number of episodes, seed, cache); None: the
    library's. Raises StudioError for fewer than one episode.
    """
    refuse_none(episodes)
    motions = motions or library
    parts: list[list[dict[str, Array]]] = [[] for _ in jobs]
    with Progress(disable=not progress, transient=True) as bar:
        task = bar.add_task("episodes", total=len(jobs) * episodes)
        # Chunks outside, so that those who meet the same motions share them.
        for chunk, begin in enumerate(range(0, episodes, CHUNK)):
            num = min(CHUNK, episodes - begin)
            banks: dict[StateName, MotionBank] = {}
            for (state, who), part in zip(jobs, parts, strict=True):
                bar.update(task, description=f"{state} {who.name}")
                file = _file(cache, motions, state, who, num, seed, chunk)
                if file is None or not file.exists():
                    if state not in banks:
                        banks = {state: motions(state, num, HELD_OUT + 1000 * seed + chunk, cache)}
                    env = who.environment(banks[state], num, 1000 * seed + chunk, threads)
                    part.append(rollouts.run_episodes(env, who.act))
                    if file:
                        save_arrays(file, part[-1])
                else:
                    with np.load(file) as saved:
                        part.append({k: saved[k] for k in saved.files})
                bar.advance(task, num)
    figures = [{k: np.concatenate([p[k] for p in part]) for k in part[0]} for part in parts]
    return [
        _row(state, who.name, seed, each) for (state, who), each in zip(jobs, figures, strict=True)
    ]


def names_of(kind: str, given: Sequence[str] | str, known: Sequence[str]) -> list[str]:
    """Names given one by one or with commas between. StudioError for one that is not known."""
    names = given.split(",") if isinstance(given, str) else list(given)
    for name in names:
        if name not in known:
            raise unknown_name(kind, name, known)
    return names


def library(state: StateName, num: int, seed: int, cache: Path | None = CACHE) -> MotionBank:
    """At least `num` held-out motions of a state's tasks, at full range, kept in `cache`."""
    tasks = len(task_names(state))
    banks = None if cache is None else cache / "banks"
    return library_bank(banks, state, per_task=-(-num // tasks), seed=seed, difficulties=(1.0,))


def _row(state: str, controller: str, seed: int, figures: dict[str, Array]) -> dict[str, Any]:
    row: dict[str, Any] = {
        "state": state,
        "controller": controller,
        "seed": seed,
        "episodes": len(figures["success_time"]),
        "commit": commit(),
    }
    for name, (key, unit) in _FIGURES.items():
        row[name] = unit(float(np.mean(figures[key])))
        low, high = bootstrap_ci(figures[key])
        row[f"{name}_ci"] = [unit(low), unit(high)]
    return row


_CODE = (
    "rl", "control", "reference", "robot", "sim", "geometry", "rhythm", "timing", "metrics",
    "evaluation/disturbed",
)  # fmt: skip
"""What a row depends on."""


def _file(
    cache: Path | None,
    motions: Motions,
    state: StateName,
    who: Contender,
    num: int,
    seed: int,
    chunk: int,
) -> Path | None:
    """Where a chunk's per-episode figures are kept."""
    if cache is None:
        return None
    key = hashlib.sha256((fingerprint(*_CODE) + who.digest).encode()).hexdigest()[:12]
    return cache / f"{motions.__name__}-{state}-{who.name}-{num}-{seed}-{chunk}-{key}.npz"
