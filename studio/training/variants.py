"""The second policies of the ablation: one recipe, one change each, 3 million samples.

    a1-studio train policy --state walk --variant no_randomisation --publish

puts the weights beside the shipped ones, in models/policy/ablation. All share a plain recipe
(nothing held, no transitions, no mirror loss, noise of 2 to 4 degrees), so that one change
at a time is seen.
"""

import json
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np

from studio.control.policy import MODELS
from studio.errors import unknown_name
from studio.files import copy_whole, write_whole
from studio.training.policy_settings import PolicyTraining
from studio.training.recipes import TAUGHT, Recipe

BUDGET = 3_000_000
PLAIN = Recipe(noise_low=float(np.radians(2.0)), mirror_loss=0.0)
VARIANTS: dict[str, dict[str, Any]] = {
    "full": {},
    "no_randomisation": {"randomise": False},
    "no_teacher": {"distil": 0},
    "no_curriculum": {"distil": 0, "curriculum": False},
    "absolute_action": {"action": "absolute"},
    "true_future": {"future": True},
}
"""What each changes. A taught policy starts at the last stage, so that a curriculum shows only
without the teacher: `no_curriculum` is to be read against `no_teacher`."""


def switched(config: PolicyTraining) -> PolicyTraining:
    """`config` with the switches that its variant is about. StudioError for an unknown name."""
    if config.variant not in VARIANTS:
        raise unknown_name("variant", str(config.variant), VARIANTS)
    return replace(config, **{k: v for k, v in VARIANTS[config.variant].items() if k != "distil"})


def stage_of(config: PolicyTraining) -> PolicyTraining:
    """The plain run that variants change, of `config`'s state."""
    name = config.variant or "full"
    return replace(
        config,
        samples=BUDGET,
        run=Path("runs/ablation") / stem(config.state, name),
        transitions=0,
        people=0,
        recipe=PLAIN,
        distil=VARIANTS[name].get("distil", TAUGHT[config.state]),
    )


def stem(state: str, name: str) -> str:
    """The file name of a variant's weights."""
    return f"{state}-{name}"


def weights(state: str, name: str, models: Path = MODELS) -> Path:
    """Where a variant's weights lie once trained."""
    return models / "ablation" / f"{stem(state, name)}.safetensors"


def publish(source: Path, target: Path, name: str) -> None:
    """Copy weights and sidecar, which then says which variant it is and what that changes."""
    copy_whole(source, target)
    manifest = json.loads(source.with_suffix(".json").read_text())
    manifest["variant"] = {"name": name, "changes": VARIANTS[name]}
    write_whole(target.with_suffix(".json"), json.dumps(manifest, indent=1) + "\n")
