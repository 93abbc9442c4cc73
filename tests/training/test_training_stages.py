"""One command makes a shipped policy: which stages it has, what they are told, that they go on."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import load_file

from studio.cli.training import train
from studio.errors import StudioError
from studio.training import checkpoint, stages
from studio.training.policy_settings import PolicyTraining
from studio.training.ppo import PpoConfig
from studio.training.recipes import RECIPES
from studio.training.stages import stages_of
from studio.training.train_policy import run_train_policy

LESSON = 4 * 24
"""Samples of one lesson of four robots."""
PARTS = {"checkpoint": "checkpoint", "average": "policy"}
"""What a second stage takes of the first, and their files' names."""


def test_sitting_trains_a_teacher_and_then_what_it_teaches():
    teacher, policy = stages_of(PolicyTraining(state="sit", publish=True, threads=2))
    assert (teacher.privileged, teacher.samples, teacher.transitions) == (True, 4_800_000, 48)
    assert (teacher.push, teacher.ppo.gamma, teacher.publish) == (0.2, 0.97, False)
    assert policy.teacher == teacher.folder / "teacher.safetensors"
    assert (policy.lessons, policy.warmup, policy.clean) == (3_000_000, 80, 0.25)
    assert (policy.ppo.gamma, policy.ppo.desired_kl) == (0.98, 0.01)
    assert teacher.threads == policy.threads == 2
    assert teacher.folder != policy.folder


def test_what_was_told_holds_in_every_stage():
    told = PolicyTraining(state="sit", transitions=5, samples=10, ppo=PpoConfig(gamma=0.5))
    for stage in stages_of(told):
        assert (stage.transitions, stage.samples, stage.ppo.gamma) == (5, 10, 0.5)
    assert stages_of(told)[1].ppo.max_learning_rate == 3e-4
    assert stages_of(replace(told, ppo=PpoConfig(desired_kl=None)))[1].ppo.desired_kl is None


def test_what_is_given_holds_though_it_is_the_default(monkeypatch: pytest.MonkeyPatch):
    line = "--state sit --push 0.4 --samples 30000000 --clean 0 --warmup 10 --transitions 24"
    line += " --ppo.gamma 0.95 --ppo.desired-kl 0.015"
    given: list[PolicyTraining] = []
    monkeypatch.setattr("studio.training.train_policy.run_train_policy", given.append)
    train(["policy", *line.split()])
    for stage in stages_of(given[0]):
        assert (stage.push, stage.samples, stage.transitions) == (0.4, 30_000_000, 24)
        assert (stage.clean, stage.warmup) == (0.0, 10)
        assert (stage.ppo.gamma, stage.ppo.desired_kl) == (0.95, 0.015)
    assert stages_of(given[0])[1].ppo.max_learning_rate == 3e-4  # not given
    began, on = stages_of(PolicyTraining(state="walk", samples=9_400_000, people=12))
    assert (began.samples, on.samples, on.people) == (9_400_000, 18_800_000, 12)


def test_parts_of_a_recipe_can_be_run_alone():
    teacher, policy = stages_of(PolicyTraining(state="sit"))
    assert stages_of(PolicyTraining(state="sit", privileged=True)) == [teacher]
    assert stages_of(PolicyTraining(state="sit", teacher=policy.teacher)) == [policy]
    (stand,) = stages_of(PolicyTraining(state="stand"))
    assert (stand.push, stand.lessons) == (0.6, 800_000)
    for own in (
        PolicyTraining(state="sit", distil=0),
        PolicyTraining(state="walk", preset="paper"),
        PolicyTraining(state="walk", checkpoint=Path("c.safetensors")),
    ):
        assert stages_of(own) == [own]
    with pytest.raises(StudioError, match="no_teacher"):
        stages_of(PolicyTraining(state="walk", variant="no_teachers"))


@pytest.mark.slow
def test_stages_run_one_after_the_other_are_gone_on_with_and_published(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    monkeypatch.setattr(stages, "MODELS", tmp_path / "models")
    teacher, policy = stages.STAGES["sit"]
    monkeypatch.setitem(stages.STAGES, "sit", (teacher, replace(policy, distil=LESSON)))
    tiny = PpoConfig(horizon=6, epochs=1, minibatch=12, hidden=(8, 8))
    config = PolicyTraining(
        state="sit", samples=LESSON + 24, num_envs=4, motions_per_task=1, transitions=1, people=0,
        threads=1, ppo=tiny, publish=True,
    )  # fmt: skip

    stopped = run_train_policy(replace(config, hours=1e-9))
    assert stopped["run"] == "runs/teacher-sit"  # the hours of all were over in the first stage
    assert not (tmp_path / "models").exists()

    done = run_train_policy(replace(config, resume=True))
    assert (done["run"], done["samples"]) == ("runs/policy-sit", LESSON + 24)
    assert checkpoint.load(Path("runs/teacher-sit/checkpoint.safetensors"))[1]["samples"] == 120
    manifest = json.loads((tmp_path / "models" / "sit.json").read_text())
    assert (manifest["teacher"], manifest["lessons"], manifest["samples"]) == ("learned", 96, 120)
    made = sorted(str(p.relative_to("models")) for p in Path("models").rglob("*.safetensors"))
    assert made == ["checkpoints/sit.safetensors", "sit.safetensors", "teachers/sit.safetensors"]

    again = run_train_policy(replace(config, resume=True))
    assert again["samples"] == done["samples"]  # nothing is left to do
    variant = replace(config, variant="no_randomisation", samples=24, resume=False)
    run_train_policy(replace(variant, distil=0))
    sidecar = tmp_path / "models" / "ablation" / "sit-no_randomisation.json"
    assert json.loads(sidecar.read_text())["variant"]["changes"] == {"randomise": False}


def test_walking_goes_on_through_space_and_is_the_mean_of_both_stages():
    begun, on = stages_of(PolicyTraining(state="walk", publish=True))
    assert (begun.samples, begun.made_by.travels, begun.publish) == (9_400_000, 0, False)
    assert on.checkpoint == begun.folder / "checkpoint.safetensors"
    assert (on.samples, on.people, on.explore, on.publish) == (14_300_000, 24, 0.2, True)
    assert on.made_by.travels == 3
    assert on.average == begun.folder / "policy.safetensors"
    assert stages_of(PolicyTraining(state="walk", samples=7))[1].samples == 14


@pytest.mark.slow
def test_what_is_kept_of_the_second_stage_is_the_mean(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    monkeypatch.chdir(tmp_path)
    tiny = PpoConfig(horizon=6, epochs=1, minibatch=12, hidden=(8, 8))
    config = PolicyTraining(
        state="walk", samples=24, num_envs=4, motions_per_task=1, transitions=1, people=0,
        threads=1, ppo=tiny, run=tmp_path / "run",
    )  # fmt: skip
    plain = replace(config, recipe=RECIPES["walk"], distil=0, hours=1.0)
    done = run_train_policy(plain)
    assert done["samples"] == 24  # a recipe of one's own is one stage
    begun = plain.folder
    parts = {name: begun / f"{kind}.safetensors" for name, kind in PARTS.items()}
    run_train_policy(replace(stages_of(config)[1], distil=0, run=tmp_path / "on", **parts))
    one, both = (load_file(tmp_path / run / "policy.safetensors") for run in ("run", "on"))
    learnt = checkpoint.load(tmp_path / "on" / "checkpoint.safetensors")[0]
    weight = (one["weight_0"] + learnt["actor.mlp.0.weight"].numpy()) / 2
    np.testing.assert_allclose(both["weight_0"], weight, rtol=1e-6)
    assert np.abs(one["weight_0"] - weight).max() > 0
