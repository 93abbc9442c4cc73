"""`evaluate baselines`: the paper's comparison of methods as measured columns.

Every mapper is fitted to the same pairs, scored on the same strangers, planted by the same contact
and temporal consistency, and followed by the same policies through the same episodes. What a rival
cannot map is a row that says why.
"""

import logging
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.evaluation import baseline_figures as figures
from studio.evaluation import pair_methods
from studio.evaluation.baselines_followed import Acted, acted, endured, followed
from studio.evaluation.options import TableOptions
from studio.evaluation.pairs import HELD_OUT_SEED, clips_of
from studio.evaluation.tracking import names_of
from studio.options import STATES, StateName
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.mapper import Expert
from studio.retarget.store import load_experts
from studio.training.machine import commit
from studio.training.mapper_fit import MapperTraining
from studio.training.operator_pairs import PairSet
from studio.training.rivals import fitted
from studio.training.synthetic_pairs import make_pairs

log = logging.getLogger(__name__)
EXPERT = "expert"
"""Ours, fitted to the same pairs; it comes first, since others are timed by it."""
SHIPPED = "shipped"
"""Ours as it comes with the studio: of more pairs, and more steps."""
MAPPERS = (EXPERT, SHIPPED, *RIVALS)
FEW = 4
"""Performances that the search for the pairs needed is scored on."""
OTHER_STYLE = "circles"
"""Another motion for the same task: who can be fitted to it is flexible."""


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate baselines`."""

    episodes: int = 12
    """Performances of 10 s a state that the shipped policy follows; as many are mapped off line."""
    train_seconds: float = 300.0
    """Of a state's pairs that all are fitted to."""
    steps: int = 800
    """Gradient steps of the expert."""
    states: tuple[StateName, ...] = STATES
    """Which experts."""
    mappers: tuple[str, ...] = MAPPERS
    """Which mappers; FILE.py:Class or module:Class is one of your own."""
    people: int = 2
    """Who drive under Table I, a row; 0: nobody."""
    seconds: float = 30.0
    """How long each drives."""
    needed: bool = True
    """Also look for how many pairs each needs."""


def run_baselines(
    options: Options = Options(), *, tick: Callable[[str], None] = log.info
) -> dict[str, Any]:
    """A row per state and mapper; StudioError for an unknown name."""
    known = (*MAPPERS, *(name for name in options.mappers if ":" in name))
    chosen = sorted(names_of("mapper", options.mappers, known), key=known.index)
    rows: list[dict[str, Any]] = []
    for state in options.states:
        pairs = make_pairs(state, options.train_seconds, options.seed)
        held = strangers(state, options)
        people = acted(state, options.episodes, options.seed + HELD_OUT_SEED)
        by_expert: tuple[float, float] | None = None
        for name in chosen:
            row = _row(name, state, options, pairs, held, people)
            by_expert = by_expert or row.get("timed")
            if (own := row.pop("timed", None)) and by_expert and EXPERT in chosen:
                row["inference_ratio"] = own[0] / by_expert[0]
            rows.append(row)
            tick(f"{state} {name}: {row.get('joint_rmse_deg', row['refused'])}")
    return {"rows": rows}


def strangers(state: StateName, options: Options, style: str = "march") -> list[PairSet]:
    """Performances of people whom nothing is fitted to, mirrored copies among them."""
    seconds, seed = 10.0 * options.episodes, options.seed + HELD_OUT_SEED
    return clips_of(make_pairs(state, seconds, seed, style, "held_out"))


def fit(
    name: str, state: StateName, options: Options, pairs: PairSet, style: str = "march"
) -> Expert:
    """A mapper of MAPPERS. StudioError where it refuses the pairs."""
    if name == SHIPPED:
        return load_experts(style).mappers[state]
    if name == EXPERT:
        training = MapperTraining(seed=options.seed, steps=options.steps, resume=False)
        return pair_methods.expert(state, pairs, training)
    return fitted(name, state, pairs, options.seed)


def _row(
    name: str,
    state: StateName,
    options: Options,
    known: PairSet,
    held: list[PairSet],
    people: list[Acted],
) -> dict[str, Any]:
    row: dict[str, Any] = {
        "case": name,
        "state": state,
        "controller": name,
        "seed": options.seed,
        "episodes": options.episodes,
        "commit": commit(),
        "given": RIVALS[name].given if name in RIVALS else "every pair",
        "pairs": len(known),
        "refused": "",
    }
    fit_to = partial(fit, name, state, options)
    began = time.process_time()  # neighbours do not count
    try:
        expert = fit_to(known)
    except StudioError as why:
        return {**row, "refused": str(why)}
    row["fit_seconds"] = time.process_time() - began
    timed = figures.inference_ms(expert, np.concatenate([clip.triplet for clip in held]))
    row |= {"timed": timed, "inference_p50_ms": timed[0], "inference_p99_ms": timed[1]}
    row |= figures.errors(state, held, [expert(clip.triplet) for clip in held])
    if name == SHIPPED:
        facts = load_experts().sidecars[state]
        frames = int(facts["scores"]["train_frames"])
        row |= {"pairs": frames, "fit_seconds": facts["seconds"]}
    elif options.needed:
        row["pairs_needed"] = figures.pairs_needed(fit_to, known, held[:FEW], expert)
    if state == "walk":
        row["other_style_rmse_deg"] = _in_other_style(name, options)
    row |= followed(state, expert, people, options.seed)
    if options.people:
        row |= endured(state, expert, options.people, options.seconds, options.seed)
    return row


def _in_other_style(name: str, options: Options) -> float | None:
    """Joint error, degrees, fitted to OTHER_STYLE's walk and scored on strangers in it; None where
    it refuses."""
    known = make_pairs("walk", options.train_seconds, options.seed, OTHER_STYLE)
    try:
        expert = fit(name, "walk", options, known, OTHER_STYLE)
    except StudioError:
        return None
    return figures.bare_rmse(expert, strangers("walk", options, OTHER_STYLE)[:FEW])
