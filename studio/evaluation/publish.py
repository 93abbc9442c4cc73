"""A training run → models/policy: scored beside its baselines, kept only where it beats them.

`a1-studio publish walk --episodes 256`
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from studio.control.policy import MODELS
from studio.errors import StudioError
from studio.evaluation.tracking import Options, run_tracking
from studio.files import copy_whole, write_whole
from studio.reference.intent import StateName
from studio.training.stages import ship

SCORES = (
    "success_time_ratio",
    "tracked_time_ratio",
    "joint_rmse_deg",
    "foot_error_m",
    "orientation_error_deg",
    "velocity_error_m_s",
)
HIGHER = ("success_time_ratio", "tracked_time_ratio")


@dataclass(frozen=True, kw_only=True)
class Publish:
    """Score a trained policy beside its baselines and ship it where it beats them."""

    state: tyro.conf.Positional[StateName]
    """Which expert."""
    run: Path | None = None
    """Its training folder (default: runs/policy-STATE)."""
    episodes: int = 256
    """Episodes a controller is scored on."""
    seed: int = 1
    """Everything drawn follows from it."""
    threads: int = 0
    """Cores to use; 0: all."""
    force: bool = False
    """Ship it even where it is not better."""


def publish(config: Publish) -> dict[str, Any]:
    """Weights, sidecar with scores, and the checkpoint to resume from; returns the scores.

    StudioError if the policy does not beat PD playback on every score.
    """
    run = config.run or Path("runs") / f"policy-{config.state}"
    stage = run / "publish"
    ship(run, config.state, stage)
    options = Options(
        episodes=config.episodes,
        seed=config.seed,
        threads=config.threads,
        states=(config.state,),
        controllers=("stand_still", "pd_playback", "policy"),
    )
    rows = run_tracking(options, models=stage)["rows"]
    scores = {row["controller"]: {k: row[k] for k in row if _kept(k)} for row in rows}
    worse = [name for name in SCORES if not _better(scores, name)]
    if worse and not config.force:
        raise StudioError(f"{config.state}: not better than PD playback on {', '.join(worse)}")
    sidecar = stage / f"{config.state}.json"
    manifest = json.loads(sidecar.read_text())
    manifest["scores"] = {"episodes": config.episodes, "seed": config.seed, **scores}
    write_whole(sidecar, json.dumps(manifest, indent=1) + "\n")
    for file in sorted(p for p in stage.rglob("*") if p.is_file()):
        copy_whole(file, MODELS / file.relative_to(stage))
    return scores


def _kept(name: str) -> bool:
    return name.removesuffix("_ci") in SCORES


def _better(scores: dict[str, dict[str, Any]], name: str) -> bool:
    ours, theirs = scores["policy"][name], scores["pd_playback"][name]
    return ours >= theirs if name in HIGHER else ours < theirs
