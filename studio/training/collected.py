"""`a1-studio train mapper --takes …`: a person's own takes in, a mapper of their own out.

Reads top to bottom: pairs of the takes as their edits leave them, some held out; an expert for
each state; what it is worth beside the nearest pair, ridge regression and the shipped expert;
weights and sidecar. States without takes keep the shipped expert, and every mapper the style's
shipped selector: takes show a motion at a time, begun and ended in standing, so they hold none of
what a selector must tell apart (idle arms, brisk exercise, one state turning into another), and
fitted to one person it would call everybody else unknown. What happens on the way goes to
a progress file, a JSON object a line, for whoever watches.
"""

import json
import logging
import shutil
import time
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any, Literal

import numpy as np
from safetensors.numpy import load_file, save_file

from studio.errors import StudioError
from studio.files import whole
from studio.reference.intent import STATES, StateName
from studio.retarget.baselines.frames import FrameMapper, Targets
from studio.retarget.baselines.simple import NearestPair, Ridge
from studio.retarget.mapper import Mapper
from studio.retarget.store import load_experts, ruled, stem, style_dir
from studio.takes.names import check_name
from studio.training.enough import left_out
from studio.training.machine import commit
from studio.training.mapper_fit import MapperTraining, fit_expert, score
from studio.training.mapper_net import MapperNet
from studio.training.operator_pairs import PairSet, mirrored
from studio.training.rivals import refuse_taken
from studio.training.take_pairs import Split, read_pairs, split_pairs

log = logging.getLogger(__name__)
Say = Callable[[dict[str, Any]], None]

SCORED = 2000
"""Held-out frames that are scored at most: a search for the nearest pair takes as long as there are
pairs, for each of them."""


@dataclass(frozen=True, kw_only=True)
class TakesTraining:
    """How a mapper is trained from takes.

    takes: their names, as edited. dataset: a data set version instead. sessions: the folder they
    are in. name: of the mapper, made at SESSIONS/mappers/NAME. style: which human motion means
    walking; its shipped experts fill the states without takes. states: which experts to train.
    start: "shipped" goes on from the style's shipped expert, as little data asks for; "scratch"
    forgets it. mirror: also learn from the mirror image. steps: 0 chooses by the number of pairs.
    progress: file for a JSON line per event. learning_rate: 0 chooses by `start`. seed, hidden
    (from scratch), batch, input_noise: as for the shipped experts.
    """

    takes: tuple[str, ...] = ()
    dataset: str | None = None
    sessions: Path = Path("sessions")
    name: str | None = None
    style: Literal["march", "circles", "semantic"] = "march"
    states: tuple[StateName, ...] = STATES
    start: Literal["shipped", "scratch"] = "shipped"
    mirror: bool = True
    steps: int = 0
    seed: int = 0
    hidden: int = 128
    batch: int = 256
    learning_rate: float = 0.0
    input_noise: float = 0.2
    progress: Path | None = None


def run_train_takes(config: TakesTraining) -> dict[str, Any]:
    """Train what `config` names and write it; the sidecar as written."""
    began = time.perf_counter()
    say = _event_writer(config.progress)
    try:
        return _train(config, say, began)
    except StudioError as error:
        say({"event": "failed", "why": str(error)})
        raise


def _train(config: TakesTraining, say: Say, began: float) -> dict[str, Any]:
    name = check_name(config.name or f"mine-{datetime.now():%Y%m%d-%H%M%S}", "mapper")
    refuse_taken(name)
    shipped = load_experts(config.style)
    say({"event": "reading", "takes": len(config.takes)})
    walk = "walk" in config.states and not ruled("walk", config.style)
    found = read_pairs(config.sessions, config.takes, config.dataset, config.style, walk=walk)
    out = Path(config.sessions) / "mappers" / name
    counts = {s: found.count(s) for s in config.states}
    without = left_out(found.counts, config.states, config.style)
    enough: dict[StateName, Split] = {
        s: split_pairs(found.by_take(s)) for s in config.states if s not in without
    }
    if not enough:
        why = "; ".join(f"{s}: {reason}" for s, reason in without.items())
        raise StudioError(f"too few pairs to train on ({why}): collect more takes")
    say({"event": "pairs", "name": name, "counts": counts, "left_out": without})
    experts: dict[str, Any] = {}
    tensors: dict[str, Mapping[str, Any]] = {}
    for state, split in enough.items():
        tensors[state], experts[state] = train_state(state, split, config, shipped.mappers, say)
    about = {
        "name": name,
        "made": datetime.now().astimezone().isoformat(timespec="seconds"),
        "style": config.style,
        "dataset": found.version,
        "takes": list(found.takes),
        "states": list(enough),
        "experts": experts,
        "left_out": without,
        "seconds": round(time.perf_counter() - began, 1),
        "commit": commit(),
        "config": json.loads(
            json.dumps(asdict(config) | {"sessions": None, "progress": None}, default=str)
        ),
    }
    write_mapper(out, config.style, tensors, about)
    say({"event": "done", "name": name, "seconds": about["seconds"]})
    return about


def train_state(
    state: StateName,
    split: Split,
    config: TakesTraining,
    shipped: Mapping[str, FrameMapper],
    say: Say,
) -> tuple[Mapping[str, Any], dict[str, Any]]:
    """A state's expert and what it is worth: (its arrays, the facts of its sidecar)."""
    known = split.known
    if config.mirror:
        known = PairSet.join([known, mirrored(known)])
    further = config.start == "shipped"
    few = 300 if further else 600
    steps = config.steps or int(np.clip(len(split.known) // 2, few, 5 * few))
    settings = MapperTraining(
        style=config.style,
        seed=config.seed,
        steps=steps,
        batch=config.batch,
        hidden=config.hidden,
        learning_rate=config.learning_rate or (5e-4 if further else 2e-3),
        input_noise=config.input_noise,
        resume=False,
    )
    began = time.perf_counter()

    def watch(step: int, loss: float) -> None:
        say({"event": "loss", "state": state, "step": step, "steps": steps, "loss": round(loss, 5)})

    begin = None
    if further:
        begin = MapperNet.from_tensors(
            load_file(
                stem(style_dir(config.style), state, config.style).with_suffix(".safetensors")
            )
        )
    net = fit_expert(state, known, settings, watch=watch, net=begin)
    tensors = net.export()
    targets = Targets.of(known)
    methods: dict[str, FrameMapper] = {
        "yours": Mapper.from_tensors(tensors),
        "nearest_pair": NearestPair(known.triplet, targets),
        "ridge": Ridge(known.triplet, targets),
        "shipped": shipped[state],
    }
    rows = np.arange(len(split.held))
    if len(rows) > SCORED:
        rows = np.linspace(0, len(rows) - 1, SCORED).round().astype(int)
    held = split.held.take(rows)
    scores = {
        name: {figure: round(value, 4) for figure, value in score(method, held).items()}
        for name, method in methods.items()
    }
    facts = {
        "pairs": len(split.known),
        "held_out_pairs": len(split.held),
        "held_out": split.how,
        "takes": list(split.takes),
        "steps": steps,
        "seconds": round(time.perf_counter() - began, 1),
        "scores": scores,
    }
    say({"event": "scores", "state": state, **facts})
    return tensors, facts


def write_mapper(
    out: Path, style: str, tensors: Mapping[str, Mapping[str, Any]], about: Mapping[str, Any]
) -> None:
    """The folder of a mapper, whole or not at all: own experts, shipped ones for the rest.

    Raises StudioError if a mapper has this name, or it cannot be written.
    """
    source = style_dir(style)
    try:
        with whole(out, parents=True) as scratch:
            scratch.mkdir()
            for part in (*STATES, "selector"):
                if part in tensors:
                    save_file(dict(tensors[part]), scratch / f"{part}.safetensors")
                    facts = {"expert": part, **about["experts"][part], "dataset": about["dataset"]}
                    (scratch / f"{part}.json").write_text(json.dumps(facts, indent=1) + "\n")
                elif not ruled(part, style):
                    # Kept beside the others, so that the mapper stays what it is when these change.
                    shipped = stem(source, part, style)
                    for suffix in (".safetensors", ".json"):
                        shutil.copyfile(shipped.with_suffix(suffix), scratch / f"{part}{suffix}")
            (scratch / "mapper.json").write_text(json.dumps(about, indent=1) + "\n")
            if out.exists():
                raise StudioError(f"a mapper named {out.name} exists: choose another name")
    except OSError as error:
        raise StudioError(f"mapper {out.name} was not kept: {error.strerror}") from error


def _event_writer(file: Path | None) -> Say:
    """Appends events to the progress file, each with the seconds since the start."""
    began = time.perf_counter()
    if file is None:
        return lambda event: log.info("%s", event)
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text("")

    def say(event: dict[str, Any]) -> None:
        with file.open("a") as f:
            f.write(json.dumps({**event, "t": round(time.perf_counter() - began, 2)}) + "\n")

    return say
