"""What `train policy` runs, stage by stage: one command makes a policy of each state.

A stage sets what its run was not given: settings left at their defaults.
"""

import shutil
from collections.abc import Mapping
from dataclasses import fields, replace
from pathlib import Path
from typing import Any

from studio.control.policy import MODELS
from studio.training import variants
from studio.training.policy_settings import PolicyTraining
from studio.training.recipes import RECIPES, PolicyName

TEACHER: dict[PolicyName, dict[str, Any]] = {
    "sit": {
        "transitions": 48,
        "push": 0.2,
        "samples": 4_800_000,
        "ppo": {"gamma": 0.97},
    }
}
"""States that learn from a teacher of their own, which sees the simulation's whole state."""
POLICY: dict[PolicyName, dict[str, Any]] = {
    "stand": {"push": 0.6, "samples": 5_000_000},
    "walk": {
        "samples": 9_400_000,
        "recipe": replace(RECIPES["walk"], travels=0, motors=False, steep=0.0),
    },
    "sit": {
        "transitions": 48,
        "push": 0.2,
        "clean": 0.25,
        "distil": 3_000_000,
        "warmup": 80,
        "samples": 11_600_000,
        "ppo": {"gamma": 0.98, "desired_kl": 0.01, "max_learning_rate": 3e-4},
    },
}
"""Lessons, then PPO alone. Sitting's critic learns alone for 80 iterations first: after 10, PPO
undid what was taught."""
ON: dict[PolicyName, dict[str, Any]] = {
    "walk": {"samples": 4_900_000, "people": 24, "explore": 0.2},
}
"""States whose training goes on with the state's whole recipe, after the plain one of `POLICY`, for
so many samples more. What is kept are both stages' weights averaged: minutes of driving are better
survived by their mean than by either (models/policy/README.md)."""


def stages_of(config: PolicyTraining) -> list[PolicyTraining]:
    """The runs that `config` asks for, in order, each whole; StudioError for an unknown variant.

    One run as it stands for the paper's preset, a recipe or `distil` of one's own, or a checkpoint;
    with `privileged` the teacher's stage alone; with `teacher` the stage that it teaches.
    """
    if config.variant:
        return [with_defaults(config, variants.settings_of(config))]
    alone = config.preset != "default" or config.recipe or config.checkpoint
    if alone or (config.distil is not None and not config.teacher):
        return [config]
    last, teaches = POLICY.get(config.state, {}), TEACHER.get(config.state, {})
    if config.privileged:
        return [with_defaults(config, teaches)]
    if config.state in ON:
        return _gone_on(with_defaults(config, last))
    if config.teacher or not teaches:
        return [with_defaults(config, last)]
    run = None if config.run is None else config.run / "teacher"
    first = with_defaults(replace(config, privileged=True, publish=False, run=run), teaches)
    # Together: a run with a teacher has to have lessons.
    taught = {"teacher": first.folder / "teacher.safetensors", "distil": last["distil"]}
    return [first, with_defaults(replace(config, **taught), last)]


def _gone_on(config: PolicyTraining) -> list[PolicyTraining]:
    """`config` as a first stage, and the one that goes on from its checkpoint."""
    run = None if config.run is None else config.run / "begun"
    first = replace(config, publish=False, run=run or Path(f"runs/begun-{config.state}"))
    own = dict(ON[config.state])
    more = own.pop("samples")
    if config.samples != POLICY[config.state]["samples"]:  # one's own are each stage's
        more = config.samples
    on = replace(
        config,
        recipe=None,
        samples=config.samples + more,  # a run counts those of what it goes on from, too
        checkpoint=first.folder / "checkpoint.safetensors",
        average=first.folder / "policy.safetensors",
    )
    return [first, with_defaults(on, own)]


def with_defaults(config: PolicyTraining, changes: Mapping[str, Any]) -> PolicyTraining:
    """`config` with a stage's changes where it was left at its defaults; "ppo" field by field."""
    own = {k: v for k, v in changes.items() if k != "ppo" and _at_default(config, k)}
    ppo = {k: v for k, v in changes.get("ppo", {}).items() if _at_default(config.ppo, k)}
    return replace(config, **own, ppo=replace(config.ppo, **ppo))


def _at_default(settings: Any, name: str) -> bool:
    (default,) = (f.default for f in fields(settings) if f.name == name)
    return getattr(settings, name) == default


def publish(stages: list[PolicyTraining]) -> None:
    """Copy what finished stages made to `models/policy`: weights, sidecar, checkpoint, teacher."""
    last = stages[-1]
    name = f"{last.state}.safetensors"
    weights = last.folder / "policy.safetensors"
    if last.variant:
        target = variants.weights(last.state, last.variant, MODELS)
        target.parent.mkdir(parents=True, exist_ok=True)
        variants.publish(weights, target, last.variant)
        return
    copies = {
        weights: MODELS / name,
        weights.with_suffix(".json"): MODELS / f"{last.state}.json",
        last.folder / "checkpoint.safetensors": MODELS
        / "checkpoints"
        / f"{last.state}.safetensors",
    }
    for stage in stages[:-1]:
        if stage.privileged:
            copies[stage.folder / "teacher.safetensors"] = MODELS / "teachers" / name
    for source, target in copies.items():
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(source, target)
