"""`a1-studio train mapper`: synthetic operators' pairs in, one style's experts and selector out.

Reads top to bottom: make pairs, fit an expert, score it on people it has never seen who move in
ways it has never seen, write weights and sidecar. Resumes where it was stopped.
"""

import json
import logging
import subprocess
import time
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal, cast

import numpy as np
import torch
from rich.console import Console
from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn
from safetensors.numpy import save_file

from studio import spatial
from studio.errors import StudioError, unknown_name
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.mapper import Mapper
from studio.retarget.states import EXPERTS
from studio.retarget.store import STYLES, ruled, shared, style_dir
from studio.training import checkpoint
from studio.training.losses import OURS, LossWeights, Motion, mapper_loss
from studio.training.mapper_net import MapperNet
from studio.training.operator_pairs import PairSet, performances
from studio.training.selector_fit import fit_selector

log = logging.getLogger(__name__)
Tick = Callable[[int], None]
Watch = Callable[[int, float], None]


@dataclass(frozen=True, kw_only=True)
class MapperTraining:
    """How experts are trained.

    style: which human motion means walking. state: one expert, "selector", or "all".
    seed: everything follows from it. out: folder for the weights (default: the shipped
    models/mapper/STYLE). seconds: synthetic motion per expert, mirrored copies included.
    resume: go on from a checkpoint left by a run that was stopped. steps, batch, hidden,
    learning_rate: of the networks. input_noise: sigma added to normalised inputs.
    selector_seconds: motion for the prototypes.
    """

    style: Literal["march", "circles", "semantic"] = "march"
    state: Literal["all", "stand", "walk", "sit", "selector"] = "all"
    seed: int = 0
    out: Path | None = None
    resume: bool = True
    seconds: float = 2400.0
    steps: int = 2500
    batch: int = 256
    hidden: int = 128
    learning_rate: float = 2e-3
    input_noise: float = 0.3
    selector_seconds: float = 2400.0


def run_train_mapper(config: MapperTraining) -> dict[str, Any]:
    """Train what `config` names and write it; returns the summary."""
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
                    config.style, config.seed, config.selector_seconds, _ticker(bar, task)
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


def train_mapper(config: MapperTraining) -> dict[str, Any]:
    """The same under the name of its file."""
    return run_train_mapper(config)


def _ticker(bar: Progress, task: Any) -> Tick:
    return lambda n: bar.update(task, completed=n)


def _train_expert(
    state: StateName, config: MapperTraining, out: Path, bar: Progress
) -> tuple[dict[str, Any], dict[str, float]]:
    task = bar.add_task(f"{state}: people acting (s)", total=int(config.seconds))
    pairs = make_pairs(state, config.seconds, config.seed, config.style, tick=_ticker(bar, task))
    held = make_pairs(state, 120.0, config.seed + 10_000, config.style, family="held_out")
    task = bar.add_task(f"{state}: learning (steps)", total=config.steps)
    net = fit_expert(state, pairs, config, out / f"{state}.checkpoint", _ticker(bar, task))
    tensors = net.export()
    scores = score(Mapper.from_tensors(tensors), held)
    log.info("%s: %s", state, {k: round(v, 3) for k, v in scores.items()})
    return tensors, {**scores, "train_frames": len(pairs), "held_out_frames": len(held)}


def make_pairs(
    state: StateName,
    seconds: float,
    seed: int,
    style: str = "march",
    family: str = "default",
    tick: Tick | None = None,
) -> PairSet:
    """`seconds` of one state's pairs by ever new people of a family; the same for the same seed."""
    rng = np.random.default_rng([seed, list(EXPERTS).index(state)])
    parts: list[PairSet] = []
    frames = 0
    for pairs in performances(state, rng, seconds, family=family, style=style):
        parts.append(pairs)
        frames += len(pairs)
        if tick:
            tick(min(int(frames / 30.0), int(seconds)))
    return PairSet.join(parts)


def to_motion(pairs: PairSet) -> Motion:
    """The labels of pairs as a torch Motion."""
    from studio.retarget.mapper import RATES

    def part(name: str) -> torch.Tensor:
        return torch.from_numpy(np.ascontiguousarray(pairs.rates[:, RATES[name]]))

    return Motion(
        quat=torch.from_numpy(pairs.base_quat),
        joint_pos=torch.from_numpy(pairs.joint_pos),
        joint_vel=part("joint_vel"),
        joint_acc=part("joint_acc"),
        lin_vel=part("base_lin_vel"),
        lin_acc=part("base_lin_acc"),
        ang_vel=part("base_ang_vel"),
        ang_acc=part("base_ang_acc"),
    )


def new_net(state: StateName, pairs: PairSet, config: MapperTraining) -> MapperNet:
    """An untrained expert with the normaliser of its pairs."""
    std = pairs.triplet.std(axis=0)
    # A joint that hardly moves in training must not shout when somebody moves it a little: the
    # floor is a share of the typical spread of its block (q, q' or q'').
    blocks = std.reshape(3, -1)
    floor = np.repeat(0.25 * np.median(blocks, axis=1), blocks.shape[1])
    return MapperNet(
        pairs.triplet.mean(axis=0),
        np.maximum(std, floor),
        np.maximum(pairs.rates.std(axis=0), 1e-3),
        NEUTRAL[state].base_quat,
        hidden=config.hidden,
        seed=config.seed,
    )


def fit_expert(
    state: StateName,
    pairs: PairSet,
    config: MapperTraining,
    checkpoint_file: Path | None = None,
    tick: Tick | None = None,
    weights: LossWeights = OURS,
    save_every: int = 500,
    watch: Watch | None = None,
    net: MapperNet | None = None,
) -> MapperNet:
    """Fit mapper and contact network of one expert to its pairs; resumable through a file.

    watch: given the step and its loss, twenty steps apart. net: to go on from, normaliser and all.
    """
    net = net or new_net(state, pairs, config)
    optimizer = torch.optim.AdamW(net.parameters(), lr=config.learning_rate, weight_decay=1e-3)
    identity = {**asdict(config), "out": None, "resume": None, "expert": state}
    start = _resume(checkpoint_file, net, optimizer, identity) if config.resume else 0
    x = net.normalize(torch.from_numpy(pairs.triplet))
    label, contact = to_motion(pairs), torch.from_numpy(pairs.contact)
    generator = torch.Generator()
    for step in range(start, config.steps):
        generator.manual_seed(config.seed * 1_000_003 + step)  # so that a resumed run is the same
        rows = torch.randint(len(pairs), (config.batch,), generator=generator)
        for group in optimizer.param_groups:
            group["lr"] = config.learning_rate * _schedule(step / config.steps)
        noise = torch.randn((config.batch, x.shape[1]), generator=generator)
        motion, prob = net(x[rows] + config.input_noise * noise)
        target = Motion(**{k: getattr(label, k)[rows] for k in label.__dataclass_fields__})
        loss = mapper_loss(motion, target, weights, net.rate_scale)["total"]
        loss = loss + (prob - contact[rows]).square().sum(-1).mean()
        optimizer.zero_grad()
        loss.backward()
        torch.nn.utils.clip_grad_norm_(net.parameters(), 5.0)
        optimizer.step()
        if (step + 1) % save_every == 0 and checkpoint_file is not None:
            tensors = {**net.state_dict(), **checkpoint.flatten_optimizer(optimizer)}
            checkpoint.save(checkpoint_file, tensors, {"step": step + 1, "config": _json(identity)})
        if tick and step % 20 == 19:
            tick(step + 1)
        if watch and step % 20 == 19:
            watch(step + 1, float(loss.detach()))
    if checkpoint_file is not None:
        checkpoint_file.unlink(missing_ok=True)
    return net


def score(mapper: Mapper, pairs: PairSet) -> dict[str, float]:
    """What the bare networks are worth on pairs: before any consistency, so memoryless."""
    out = mapper(pairs.triplet)
    error = out.joint_pos - pairs.joint_pos
    said, is_so = out.contact_prob > 0.5, pairs.contact > 0.5
    hits = float(np.sum(said & is_so))
    return {
        "joint_rmse_deg": float(np.degrees(np.sqrt(np.mean(error**2)))),
        "orientation_error_deg": float(
            np.degrees(spatial.quat_angle(out.base_quat, spatial.normalize(pairs.base_quat)).mean())
        ),
        "contact_f1": 2.0 * hits / max(float(said.sum() + is_so.sum()), 1.0),
    }


def _schedule(progress: float) -> float:
    """A short warm-up, then a cosine to nothing."""
    return min(progress / 0.03, 1.0) * 0.5 * (1.0 + np.cos(np.pi * progress))


def _json(value: dict[str, Any]) -> dict[str, Any]:
    return json.loads(json.dumps(value, default=str))


def _resume(
    file: Path | None, net: MapperNet, optimizer: torch.optim.Optimizer, identity: dict[str, Any]
) -> int:
    """Load a checkpoint of the same configuration, if there is one; the step to go on from."""
    if file is None or not file.is_file():
        return 0
    try:
        tensors, facts = checkpoint.load(file)
    except StudioError as error:
        log.warning("%s", error)
        return 0
    if facts.get("config") != _json(identity):
        log.warning("%s is of another configuration: starting afresh", file.name)
        return 0
    own = net.state_dict()
    net.load_state_dict({name: tensors[name] for name in own})
    checkpoint.restore_optimizer(optimizer, tensors)
    return int(facts["step"])


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
        "data": "synthetic operators, family default; held out: family held_out, other bodies",
        "seed": config.seed,
        "commit": commit(),
        "seconds": seconds,
        "scores": {k: round(float(v), 4) for k, v in scores.items()},
        "config": _json({**asdict(config), "out": None}),
    }
    for path, write in (
        (stem.with_suffix(".safetensors"), lambda p: save_file(tensors, p)),
        (stem.with_suffix(".json"), lambda p: p.write_text(json.dumps(row, indent=1) + "\n")),
    ):
        scratch = path.with_suffix(path.suffix + ".tmp")
        write(scratch)
        scratch.replace(path)
    return row


def commit() -> str:
    """The repository's commit, or "unknown" outside of one."""
    try:
        done = subprocess.run(
            ["git", "rev-parse", "--short", "HEAD"],
            capture_output=True,
            text=True,
            check=True,
            cwd=Path(__file__).parent,
        )
    except (OSError, subprocess.CalledProcessError):
        return "unknown"
    return done.stdout.strip()
