"""The controllers that a table compares, each with the environment that it needs.

A baseline needs none of its own; a policy brings the observation and action it was trained with;
the monolithic policy reads every state's tilts as a standing robot's.
"""

import hashlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path

from studio.control.policy import MODELS, Policy
from studio.reference.intent import StateName
from studio.rl import rollouts
from studio.rl.bank import MotionBank, relevelled
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.training.variants import weights

BASELINES = {"stand_still": rollouts.stand_still, "pd_playback": rollouts.pd_playback}
CONTENDERS = ("stand_still", "pd_playback", "policy", "policy_true_future", "monolithic")
"""The rows of the tracking table; the last two are trained at the ablation's budget."""


@dataclass(frozen=True, kw_only=True)
class Contender:
    """act: decides in the environment that `environment` makes. digest: of its weights, or ""."""

    name: str
    act: rollouts.Act
    settings: EnvConfig = field(default_factory=EnvConfig)
    level: StateName | None = None
    digest: str = ""

    def environment(self, bank: MotionBank, num: int, seed: int, threads: int = 0) -> ImitationEnv:
        """`num` episodes of the bank under full Table I: for one seed, the same for everybody."""
        if self.level is not None:
            bank = relevelled(bank, self.level)
        return rollouts.evaluation_env(bank, num, seed, threads=threads, settings=self.settings)


def baseline(name: str) -> Contender:
    """stand_still or pd_playback."""
    return Contender(name=name, act=BASELINES[name])


def trained(name: str, path: Path) -> Contender:
    """A policy from its weights. StudioError if they are missing or damaged."""
    policy = Policy.load(path)
    state = policy.manifest["state"]
    return Contender(
        name=name,
        act=rollouts.policy_of(policy),
        settings=EnvConfig(observation=policy.observation, action=policy.action_config),
        level="stand" if state == "all" else None,
        digest=hashlib.sha256(path.read_bytes()).hexdigest(),
    )


def path_of(name: str, state: StateName, models: Path = MODELS) -> Path:
    """Where a trained row's weights lie."""
    places: dict[str, Callable[[], Path]] = {
        "policy": lambda: models / f"{state}.safetensors",
        "policy_true_future": lambda: weights(state, "true_future", models),
        "monolithic": lambda: weights("all", "full", models),
    }
    return places[name]()


def contender(name: str, state: StateName, models: Path = MODELS) -> Contender | None:
    """A row of CONTENDERS for one state; None where its weights are not trained."""
    if name in BASELINES:
        return baseline(name)
    path = path_of(name, state, models)
    return trained(name, path) if path.exists() else None
