"""`a1-studio train mapper`: synthetic operators' pairs in, one style's experts and selector out.

Reads top to bottom: make pairs, fit an expert (`mapper_fit`), score it on people it has never seen
who move in ways it has never seen, write weights and sidecar. Resumes where it was stopped.
"""

import json
import logging
import time
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from safetensors.numpy import save_file

from studio.errors import StudioError, unknown_name
from studio.files import whole
from studio.options import STYLES
from studio.reference.intent import StateName
from studio.retarget.experts import EXPERTS
from studio.retarget.mapper import Mapper
from studio.retarget.store import ruled, shared, style_dir
from studio.training.machine import commit
from studio.training.mapper_fit import MapperTraining, OnStep, fit_expert, plain_json, score
from studio.training.selector_fit import fit_selector
from studio.training.synthetic_pairs import make_pairs

log = logging.getLogger(__name__)


def run_train_mapper(config: MapperTraining) -> dict[str, Any]:
    """Train what `config` names and write it; returns the summary.

    Raises StudioError for an unknown style, and where there is nothing to train.
    """
    if config.style not in STYLES:
        raise unknown_name("style", config.style, STYLES)
    out = config.out or style_dir(config.style)
    out.mkdir(parents=True, exist_ok=True)
    parts = parts_of(config)
    columns = (TextColumn("{task.description}"), BarColumn(), MofNCompleteColumn())
    console = Console(stderr=True)
    rows = []
    with Progress(*columns, TimeRemainingColumn(), console=console, transient=True) as bar:
        for part in parts:
            began = time.perf_counter()
            if part == "selector":
                task = bar.add_task("selector: people moving", total=int(config.selector_seconds))
                tensors, scores = fit_selector(
                    config.style,
                    config.seed,
                    config.selector_seconds,
                    _ticker(bar, task),
                    config.people,
                )
            else:
                tensors, scores = _train_expert(cast(StateName, part), config, out, bar)
            seconds = round(time.perf_counter() - began, 1)
            rows.append(_write(out, part, config, tensors, scores, seconds))
    return {"style": config.style, "out": out.name, "rows": rows}


def parts_of(config: MapperTraining) -> tuple[str, ...]:
    """What to train: of "all", what the style does not share. StudioError if nothing."""
    if ruled(config.state, config.style):
        raise StudioError(
            f"style {config.style} walks by rules: there is nothing to train for walk"
        )
    if config.state != "all":
        return (config.state,)
    own = tuple(p for p in (*EXPERTS, "selector") if not shared(p, config.style))
    own = tuple(p for p in own if not ruled(p, config.style))
    if not own:
        raise StudioError(
            f"style {config.style} shares stand, sit and selector with march and walks by rules: "
            "train those with --style march, or name one with --state"
        )
    return own


def _ticker(bar: Progress, task: Any) -> OnStep:
    return lambda n: bar.update(task, completed=n)


def _train_expert(
    state: StateName, config: MapperTraining, out: Path, bar: Progress
) -> tuple[dict[str, Any], dict[str, float]]:
    task = bar.add_task(f"{state}: people acting (s)", total=int(config.seconds))
    pairs = make_pairs(
        state, config.seconds, config.seed, config.style, config.people, _ticker(bar, task)
    )
    held = make_pairs(state, 120.0, config.seed + 10_000, config.style, family="held_out")
    task = bar.add_task(f"{state}: learning (steps)", total=config.steps)
    net = fit_expert(state, pairs, config, out / f"{state}.checkpoint", _ticker(bar, task))
    tensors = net.export()
    scores = score(Mapper.from_tensors(tensors), held)
    log.info("%s: %s", state, {k: round(v, 3) for k, v in scores.items()})
    return tensors, {**scores, "train_frames": len(pairs), "held_out_frames": len(held)}


def _write(
    out: Path,
    part: str,
    config: MapperTraining,
    tensors: dict[str, Any],
    scores: dict[str, float],
    seconds: float,
) -> dict[str, Any]:
    """Weights and sidecar, each whole or not at all; returns the summary's row."""
    stem = out / part
    row = {
        "expert": part,
        "data": f"synthetic operators, family {config.people}; "
        "held out: family held_out, other bodies",
        "seed": config.seed,
        "commit": commit(),
        "seconds": seconds,
        "scores": {k: round(float(v), 4) for k, v in scores.items()},
        "config": plain_json({**asdict(config), "out": None}),
    }
    for path, write in (
        (stem.with_suffix(".safetensors"), lambda p: save_file(tensors, p)),
        (stem.with_suffix(".json"), lambda p: p.write_text(json.dumps(row, indent=1) + "\n")),
    ):
        with whole(path) as scratch:
            write(scratch)
    return row
