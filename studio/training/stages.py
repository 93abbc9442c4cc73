"""What `train policy` runs, stage by stage: one command makes a policy of each state.

A stage is a whole run's settings; what a run was given goes before what its stages say.
"""

from dataclasses import fields, replace
from pathlib import Path

from studio.control.policy import MODELS
from studio.files import copy_whole
from studio.training import variants
from studio.training.policy_settings import PolicyTraining
from studio.training.ppo import PpoConfig
from studio.training.recipes import RECIPES, TAUGHT, PolicyName
from studio.training.usual import given

STAGES: dict[PolicyName, tuple[PolicyTraining, ...]] = {
    "stand": (
        PolicyTraining(
            state="stand",
            recipe=RECIPES["stand"],
            distil=TAUGHT["stand"],
            push=0.6,
            samples=5_000_000,
        ),
    ),
    "walk": (
        PolicyTraining(
            state="walk",
            recipe=replace(RECIPES["walk"], travels=0, motors=False, steep=0.0),
            distil=TAUGHT["walk"],
            samples=9_400_000,
        ),
        PolicyTraining(
            state="walk",
            recipe=RECIPES["walk"],
            distil=TAUGHT["walk"],
            people=24,
            explore=0.2,
            samples=4_900_000,
        ),
    ),
    "sit": (
        PolicyTraining(
            state="sit",
            privileged=True,
            recipe=RECIPES["sit"],
            transitions=48,
            push=0.2,
            samples=4_800_000,
            ppo=PpoConfig(gamma=0.97),
        ),
        PolicyTraining(
            state="sit",
            recipe=RECIPES["sit"],
            distil=3_000_000,
            warmup=80,
            transitions=48,
            push=0.2,
            clean=0.25,
            samples=11_600_000,
            ppo=PpoConfig(gamma=0.98, desired_kl=0.01, max_learning_rate=3e-4),
        ),
    ),
    "all": (PolicyTraining(state="all", recipe=RECIPES["all"], distil=TAUGHT["all"]),),
}
"""Every shipped policy. Sitting first trains a teacher, which sees the simulation's whole state;
its lessons come first in the second stage, and the critic then learns alone for 80 iterations:
after 10, PPO undid what was taught. Walking's second stage goes on from its first, for so many
samples more, with the state's whole recipe; what is kept are both stages' weights averaged: minutes
of driving are better survived by their mean than by either (models/policy/README.md)."""


def stages_of(config: PolicyTraining) -> list[PolicyTraining]:
    """The runs that `config` asks for, in order, each whole; StudioError for an unknown variant.

    One run as it stands for the paper's preset, a recipe or `distil` of one's own, or a checkpoint;
    with `privileged` the teacher's stage alone; with `teacher` the stage that it teaches.
    """
    if config.variant:
        return [told(variants.switched(config), variants.stage_of(config))]
    alone = config.preset != "default" or config.recipe or config.checkpoint
    if alone or (config.distil is not None and not config.teacher):
        return [config]
    stages = STAGES[config.state]
    first, last = stages[0], stages[-1]
    if config.privileged:
        return [told(config, first) if first.privileged else config]
    if len(stages) == 1 or (config.teacher and first.privileged):
        return [told(config, last)]
    return (_taught if first.privileged else _gone_on)(config, first, last)


def told(config: PolicyTraining, stage: PolicyTraining) -> PolicyTraining:
    """`config`, and where it was not given a setting, what the stage has."""
    own = {f.name: getattr(config, f.name) for f in fields(config)}
    ppo = {f.name: getattr(config.ppo, f.name) for f in fields(config.ppo)}
    # Among PPO's figures None is one: no KL to steer the rate by.
    own.update({k: getattr(stage, k) for k, v in own.items() if v is None or not given(v)})
    ppo.update({k: getattr(stage.ppo, k) for k, v in ppo.items() if not given(v)})
    return replace(config, **{**own, "ppo": replace(config.ppo, **ppo)})


def _taught(
    config: PolicyTraining, first: PolicyTraining, last: PolicyTraining
) -> list[PolicyTraining]:
    """A teacher's run, and that of whom it teaches."""
    run = None if config.run is None else config.run / "teacher"
    teacher = told(replace(config, privileged=True, publish=False, run=run), first)
    # Together: a run with a teacher has to have lessons.
    weights = teacher.folder / "teacher.safetensors"
    return [teacher, told(replace(config, teacher=weights, distil=last.distil), last)]


def _gone_on(
    config: PolicyTraining, first: PolicyTraining, last: PolicyTraining
) -> list[PolicyTraining]:
    """A first stage, and the one that goes on from its checkpoint."""
    run = None if config.run is None else config.run / "begun"
    begun = replace(config, publish=False, run=run or Path(f"runs/begun-{config.state}"))
    begun, on = told(begun, first), told(config, last)
    on = replace(
        on,
        samples=begun.samples + on.samples,  # a run counts those of what it goes on from, too
        checkpoint=begun.folder / "checkpoint.safetensors",
        average=begun.folder / "policy.safetensors",
    )
    return [begun, on]


def publish(stages: list[PolicyTraining]) -> None:
    """Copy what finished stages made to `models/policy`: weights, sidecar, checkpoint, teacher."""
    last = stages[-1]
    name = f"{last.state}.safetensors"
    if last.variant:
        target = variants.weights(last.state, last.variant, MODELS)
        variants.publish(last.folder / "policy.safetensors", target, last.variant)
        return
    ship(last.folder, last.state, MODELS)
    for stage in stages[:-1]:
        if stage.privileged:
            copy_whole(stage.folder / "teacher.safetensors", MODELS / "teachers" / name)


def ship(run: Path, state: str, models: Path) -> None:
    """Copy a run's weights, checkpoint and, last, sidecar to a folder of models, each whole."""
    copy_whole(run / "policy.safetensors", models / f"{state}.safetensors")
    copy_whole(run / "checkpoint.safetensors", models / "checkpoints" / f"{state}.safetensors")
    copy_whole(run / "policy.json", models / f"{state}.json")
