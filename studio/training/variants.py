"""The second policies of the ablation: one recipe, one change each, 3 million samples.

    python -m studio.training.variants walk no_randomisation

goes on where an earlier run of it stopped, and puts the weights beside the shipped ones, in
models/policy/ablation. All share a plain recipe (nothing held, no crossings, no mirror loss,
reference noise of 2 to 4 degrees), so that one change at a time is seen.
"""

import json
import logging
import shutil
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import tyro

from studio.control.policy import MODELS
from studio.errors import StudioError, unknown_name
from studio.training.policy import run_train_policy
from studio.training.policy_settings import PolicyName, PolicyTraining, Recipe

BUDGET = 3_000_000
PLAIN = Recipe(noise_low=float(np.radians(2.0)), mirror_loss=0.0)
TAUGHT: dict[PolicyName, int] = {"stand": 800_000, "walk": 800_000, "sit": 0, "all": 800_000}
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


@dataclass(frozen=True, kw_only=True)
class Variant:
    """state: of the expert, or "all" for the monolithic policy. name: a key of VARIANTS."""

    state: tyro.conf.Positional[PolicyName]
    name: tyro.conf.Positional[str] = "full"
    samples: int = BUDGET
    threads: int = 0


def settings_of(variant: Variant) -> PolicyTraining:
    """The training settings of a variant. StudioError for an unknown name."""
    if variant.name not in VARIANTS:
        raise unknown_name("variant", variant.name, VARIANTS)
    plain = PolicyTraining(
        state=variant.state,
        samples=variant.samples,
        threads=variant.threads,
        run=Path("runs/ablation") / stem(variant.state, variant.name),
        crossings=0,
        people=0,
        recipe=PLAIN,
        distil=TAUGHT[variant.state],
    )
    return replace(plain, **VARIANTS[variant.name])


def stem(state: str, name: str) -> str:
    """The file name of a variant's weights."""
    return f"{state}-{name}"


def weights(state: str, name: str, models: Path = MODELS) -> Path:
    """Where a variant's weights lie once trained."""
    return models / "ablation" / f"{stem(state, name)}.safetensors"


def train_variant(variant: Variant) -> dict[str, Any]:
    """Train or go on, then publish; the object of `train policy`."""
    config = settings_of(variant)
    if (config.folder / "checkpoint.safetensors").exists():
        config = replace(config, resume=True)
    done = run_train_policy(config)
    if done["samples"] < variant.samples:
        raise StudioError(f"{config.folder} stopped at {done['samples']} samples; run it again")
    target = weights(variant.state, variant.name)
    target.parent.mkdir(parents=True, exist_ok=True)
    publish(config.folder / "policy.safetensors", target, variant.name)
    return done


def publish(source: Path, target: Path, name: str) -> None:
    """Copy weights and sidecar, which then says which variant it is and what that changes."""
    shutil.copy(source, target)
    manifest = json.loads(source.with_suffix(".json").read_text())
    manifest["variant"] = {"name": name, "changes": VARIANTS[name]}
    target.with_suffix(".json").write_text(json.dumps(manifest, indent=1) + "\n")


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    train_variant(tyro.cli(Variant))
