"""How well references are tracked under Table I: stand still, PD playback and the policies.

Success time alone can be gamed (standing still never falls), so the tracked-time ratio and the
errors stand beside it. Every controller meets the same references, dynamics and noise.
"""

import hashlib
import logging
import subprocess
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray
from rich.progress import Progress

from studio.errors import StudioError, unknown_name
from studio.imitation import episodes as simulate
from studio.imitation.bank import build_bank, task_names
from studio.imitation.policy import MODELS, Policy
from studio.metrics import bootstrap_ci
from studio.reference.intent import STATES, StateName

log = logging.getLogger(__name__)
Array = NDArray[np.float64]

CHUNK = 256
"""Episodes simulated side by side; what is cached and resumed."""
HELD_OUT = 10_000
"""Added to the seed of the motions: training's banks use seeds below it."""
CONTROLLERS = ("stand_still", "pd_playback", "policy")

# Name in a row: (figure of an episode, from the mean to the row's unit).
_FIGURES: dict[str, tuple[str, Callable[[float], float]]] = {
    "success_time_ratio": ("success_time", float),
    "tracked_time_ratio": ("tracked_time", float),
    "joint_rmse_deg": ("joint_ms", lambda x: float(np.rad2deg(np.sqrt(x)))),
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


def run_tracking(
    episodes: int = 1024,
    seed: int = 0,
    *,
    states: Sequence[StateName] | str = STATES,
    controllers: Sequence[str] | str = CONTROLLERS,
    threads: int | str = 0,
    models: Path = MODELS,
    cache: Path | None = Path("runs/evaluate"),
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}`, a row per state and controller, each figure with its 95 % `*_ci`.

    Rows of policies that are not trained (STATE.safetensors in `models`) are left out. Chunks of
    episodes are kept in `cache`: a run that was cut off goes on where it stopped. From the command
    line states and controllers are names with commas between. StudioError for unknown names.
    """
    wanted = cast(list[StateName], _names("state", states, STATES))
    controllers = _names("controller", controllers, CONTROLLERS)
    threads = int(threads)
    if episodes < 1:
        raise StudioError("evaluate tracking needs --episodes of at least 1")
    jobs = [
        (s, c)
        for s in wanted
        for c in controllers
        if c != "policy" or (models / f"{s}.safetensors").exists()
    ]
    rows = []
    with Progress(disable=not progress, transient=True) as bar:
        task = bar.add_task("tracking", total=len(jobs) * episodes)
        for state, controller in jobs:
            bar.update(task, description=f"{state} {controller}")
            parts = []
            for part in _chunks(
                cast(StateName, state), controller, episodes, seed, threads, models, cache
            ):
                parts.append(part)
                bar.advance(task, len(part["success_time"]))
            figures = {k: np.concatenate([p[k] for p in parts]) for k in parts[0]}
            rows.append(_row(state, controller, seed, figures))
    return {"rows": rows}


def _names(kind: str, given: Sequence[str] | str, known: Sequence[str]) -> list[str]:
    names = given.split(",") if isinstance(given, str) else list(given)
    for name in names:
        if name not in known:
            raise unknown_name(kind, name, known)
    return names


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


def _chunks(
    state: StateName,
    controller: str,
    episodes: int,
    seed: int,
    threads: int,
    models: Path,
    cache: Path | None,
) -> Iterator[dict[str, Array]]:
    """Per-episode figures, chunk by chunk, from the cache where it has them."""
    tasks = len(task_names(state))
    for chunk, start in enumerate(range(0, episodes, CHUNK)):
        num = min(CHUNK, episodes - start)
        file = None
        if cache:
            key = _code()
            if controller == "policy":
                key += hashlib.sha256((models / f"{state}.safetensors").read_bytes()).hexdigest()
            name = f"{state}-{controller}-{num}-{seed}-{chunk}"
            file = cache / f"tracking-{name}-{hashlib.sha256(key.encode()).hexdigest()[:12]}.npz"
            if file.exists():
                with np.load(file) as saved:
                    yield {k: saved[k] for k in saved.files}
                continue
        bank = build_bank(
            state,
            per_task=-(-num // tasks),
            seed=HELD_OUT + 1000 * seed + chunk,
            difficulties=(1.0,),
        )
        env = simulate.evaluation_env(bank, num, 1000 * seed + chunk, threads=threads)
        figures = simulate.run_episodes(env, _act(state, controller, models))
        if file:
            file.parent.mkdir(parents=True, exist_ok=True)
            scratch = file.with_suffix(".tmp.npz")
            np.savez(scratch, **figures)  # type: ignore[arg-type]
            scratch.rename(file)
        yield figures


def _act(state: StateName, controller: str, models: Path) -> simulate.Act:
    if controller == "policy":
        return simulate.policy_of(Policy.load(models / f"{state}.safetensors"))
    return {"stand_still": simulate.stand_still, "pd_playback": simulate.pd_playback}[controller]


def _code() -> str:
    """Changes with any code that a row depends on."""
    studio = Path(__file__).resolve().parents[1]
    files = [
        f
        for room in ("imitation", "reference", "robot", "sim")
        for f in (studio / room).rglob("*.py")
    ]
    return hashlib.sha256(b"".join(f.read_bytes() for f in sorted(files))).hexdigest()


def commit() -> str:
    """The repository's commit, "" outside one."""
    done = subprocess.run(
        ["git", "rev-parse", "--short=12", "HEAD"],
        capture_output=True,
        text=True,
        check=False,
        cwd=Path(__file__).parent,
    )
    return done.stdout.strip()
