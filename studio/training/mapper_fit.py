"""Pairs in, one expert's network out: the gradient steps, resumable, and what the result is worth.

Where the pairs come from and where the weights go is `train_mapper` (synthetic operators) and
`collected` (takes).
"""

import json
import logging
from collections.abc import Callable
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
import torch

from studio import geometry, metrics
from studio.errors import StudioError
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.baselines.frames import FrameMapper
from studio.retarget.mapper import RATES
from studio.retarget.network import z_scores
from studio.training import checkpoint
from studio.training.losses import OURS, LossWeights, Motion, mapper_loss
from studio.training.mapper_net import MapperNet
from studio.training.operator_pairs import PairSet

log = logging.getLogger(__name__)
OnStep = Callable[[int], None]
Watch = Callable[[int, float], None]


@dataclass(frozen=True, kw_only=True)
class MapperTraining:
    """How experts are trained.

    style: which human motion means walking. state: one expert, "selector", or "all".
    people: family of the synthetic people, or half of each. seed: everything follows from it.
    out: folder for the weights (default: the shipped models/mapper/STYLE). seconds: synthetic
    motion per expert, mirrored copies included. resume: go on from a checkpoint left by a run that
    was stopped. steps, batch, hidden, learning_rate: of the networks. input_noise: sigma added to
    normalised inputs. selector_seconds: motion for the prototypes.
    """

    style: Literal["march", "circles", "semantic"] = "march"
    state: Literal["all", "stand", "walk", "sit", "selector"] = "all"
    people: Literal["default", "wide", "mixed"] = "default"
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


def new_net(state: StateName, pairs: PairSet, config: MapperTraining) -> MapperNet:
    """An untrained expert with the normaliser of its pairs."""
    return MapperNet(
        *z_scores(pairs.triplet),
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
    tick: OnStep | None = None,
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
            checkpoint.save(
                checkpoint_file, tensors, {"step": step + 1, "config": plain_json(identity)}
            )
        if tick and step % 20 == 19:
            tick(step + 1)
        if watch and step % 20 == 19:
            watch(step + 1, float(loss.detach()))
    if checkpoint_file is not None:
        checkpoint_file.unlink(missing_ok=True)
    return net


def score(mapper: FrameMapper, pairs: PairSet) -> dict[str, float]:
    """What the bare networks are worth on pairs: before any consistency, so memoryless.

    joint_rmse_deg, orientation_error_deg (degrees) and contact_f1 of `metrics`.
    """
    out = mapper(pairs.triplet)
    return {
        "joint_rmse_deg": metrics.joint_rmse_deg(out.joint_pos, pairs.joint_pos),
        "orientation_error_deg": metrics.orientation_error_deg(
            out.base_quat, geometry.normalize(pairs.base_quat)
        ),
        "contact_f1": metrics.contact_f1(out.contact_prob, pairs.contact),
    }


def to_motion(pairs: PairSet) -> Motion:
    """The labels of pairs as a torch Motion."""

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


def _schedule(progress: float) -> float:
    """A short warm-up, then a cosine to nothing."""
    return min(progress / 0.03, 1.0) * 0.5 * (1.0 + np.cos(np.pi * progress))


def plain_json(value: dict[str, Any]) -> dict[str, Any]:
    """The same as JSON gives it back: paths as text, tuples as lists."""
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
    if facts.get("config") != plain_json(identity):
        log.warning("%s is of another configuration: starting afresh", file.name)
        return 0
    own = net.state_dict()
    net.load_state_dict({name: tensors[name] for name in own})
    checkpoint.restore_optimizer(optimizer, tensors)
    return int(facts["step"])
