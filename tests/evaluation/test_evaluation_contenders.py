"""The rows of the policy tables: trained ones where there are weights, each on its own terms."""

import json
from pathlib import Path

import numpy as np
import pytest

from studio.control.policy import MODELS, Policy, save_policy
from studio.evaluation import ablation, kicks, transitions
from studio.evaluation.ablation import CONSISTENCY, run_ablation
from studio.evaluation.contenders import contender, trained
from studio.evaluation.kicks import run_kicks
from studio.evaluation.transitions import in_charge, run_transitions, transitions_from
from studio.reference.intent import STATES
from studio.rl.bank import build_bank
from studio.rl.env_config import EnvConfig
from studio.training.distil import DistilConfig
from studio.training.policy_settings import PolicyTraining, make_environment
from studio.training.policy_trainer import PolicyTrainer
from studio.training.ppo import PpoConfig
from studio.training.recipes import Recipe
from studio.training.stages import stages_of
from studio.training.variants import VARIANTS, publish, weights

TINY = {"num_envs": 4, "threads": 1, "motions_per_task": 1, "transitions": 0, "people": 0}


def save_untrained(path: Path, state: str, **settings: object) -> None:
    ppo = PpoConfig(horizon=2, epochs=1, minibatch=4, hidden=(8, 8))
    config = PolicyTraining(state=state, ppo=ppo, recipe=Recipe(), **TINY, **settings)  # type: ignore[arg-type]
    trainer = PolicyTrainer(config, make_environment(config, cache=None))
    save_policy(path, trainer.tensors(), trainer.manifest(scores={}))


def test_rows_without_weights_are_left_out(tmp_path: Path) -> None:
    assert contender("policy", "stand", tmp_path) is None
    assert contender("policy_true_future", "stand", tmp_path) is None
    assert contender("pd_playback", "stand", tmp_path) is not None


@pytest.mark.slow
def test_a_policy_with_the_true_future_sees_the_clean_reference_ahead(tmp_path: Path) -> None:
    path = weights("sit", "true_future", tmp_path)
    save_untrained(path, "sit", future=True)
    who = contender("policy_true_future", "sit", tmp_path)
    assert who is not None
    bank = build_bank("sit", per_task=1, seconds=2.0, difficulties=(1.0,))
    env = who.environment(bank, 3, 0, threads=1)
    env.reset()
    ahead = env.observation()[:, -54:].reshape(3, 3, 18)
    for i, k in enumerate((3, 6, 9)):
        np.testing.assert_allclose(ahead[:, i], bank.feature[env.motion, env.frame + k], atol=1e-6)
    assert who.act(env).action.shape == (3, 12)


@pytest.mark.slow
def test_the_monolithic_policy_meets_every_state_levelled_as_standing(tmp_path: Path) -> None:
    path = weights("all", "full", tmp_path)
    save_untrained(path, "all")
    who = trained("monolithic", path)
    bank = build_bank("sit", per_task=1, seconds=2.0, difficulties=(1.0,))
    env = who.environment(bank, 3, 0, threads=1)
    env.reset()
    assert env.bank.state == "stand"
    assert env.bank.leg_contact
    assert np.all(np.abs(env.observation()[:, 13]) > np.radians(40.0))  # a steep trunk


def test_every_variant_changes_one_thing_of_one_recipe() -> None:
    full = stages_of(PolicyTraining(state="walk", variant="full"))[0]
    for name in VARIANTS:
        config = stages_of(PolicyTraining(state="walk", variant=name))[0]
        changed = [
            key
            for key in vars(config)
            if key not in ("run", "variant") and getattr(config, key) != getattr(full, key)
        ]
        assert len(changed) <= 2, name
        assert config.samples == 3_000_000


def test_a_published_variant_says_what_it_changes(tmp_path: Path) -> None:
    source, target = tmp_path / "policy.safetensors", tmp_path / "walk-no_teacher.safetensors"
    source.write_bytes(b"weights")
    source.with_suffix(".json").write_text('{"state": "walk"}')
    publish(source, target, "no_teacher")
    assert target.read_bytes() == b"weights"
    assert json.loads(target.with_suffix(".json").read_text()) == {
        "state": "walk",
        "variant": {"name": "no_teacher", "changes": {"distil": 0}},
    }


@pytest.mark.parametrize("file", sorted((MODELS / "ablation").glob("*.json")), ids=lambda f: f.stem)
def test_every_shipped_variants_sidecar_is_true(file: Path) -> None:
    state, name = file.stem.split("-")
    facts = json.loads(file.read_text())
    assert facts["variant"] == {"name": name, "changes": VARIANTS[name]}
    told = stages_of(PolicyTraining(state=state, variant=name))[0]  # type: ignore[arg-type]
    # Lessons end with a whole rollout; sidecars that do not tell them say what was asked for.
    each = DistilConfig.horizon * told.num_envs
    whole = each * -(-told.lessons // each)
    assert facts["recipe"]["distil"] == (whole if "lessons" in facts else told.lessons)


def test_checkpoints_are_small_enough_for_the_repository() -> None:
    files = sorted((MODELS / "checkpoints").glob("*.safetensors"))
    assert [f.stem for f in files] == sorted(STATES)
    assert max(f.stat().st_size for f in files) < 6_000_000


def test_the_pd_enters_a_state_whose_policy_was_not_trained_to(tmp_path: Path) -> None:
    assert in_charge("sit", tmp_path) == "pd_playback"
    (tmp_path / "sit.json").write_text('{"transitions": false}')
    assert in_charge("sit", tmp_path) == "pd_playback"
    (tmp_path / "sit.json").write_text('{"transitions": true}')
    assert in_charge("sit", tmp_path) == "policy"


@pytest.mark.slow
def test_fewer_survive_with_a_kick_than_without(tmp_path: Path) -> None:
    rows = run_kicks(kicks.Options(episodes=4, threads=1), models=tmp_path)[
        "rows"
    ]  # no policies there
    assert [(r["state"], r["controller"]) for r in rows] == [
        ("stand", "pd_playback"),
        ("walk", "pd_playback"),
    ]
    assert [r["kick_m_s"] for r in rows] == [0.5, 0.3]
    for row in rows:
        assert 0.0 <= row["survived"] <= row["survived_unkicked"] <= 1.0


@pytest.mark.slow
def test_the_ablation_switches_consistency_off_at_test_time(tmp_path: Path) -> None:
    options = ablation.Options(episodes=2, states=("sit",), threads=1)
    rows = run_ablation(options, models=tmp_path, cache=None, progress=False)["rows"]
    assert {(r["kind"], r["state"], r["controller"]) for r in rows} == {
        ("test", "sit", "pd_playback")
    }
    assert set(CONSISTENCY) <= {r["variant"] for r in rows}
    jerk = {r["variant"]: r["jerk_rad_s3"] for r in rows}
    assert jerk["no_temporal_consistency"] > jerk["both"]


def test_crossings_are_judged_from_their_first_frame() -> None:
    bank = transitions_from("sit")("stand", 2, 3, None)
    assert (len(bank), bank.frames, bank.tasks) == (2, 301, ("from_sit",))
    assert bank.leg_contact
    assert EnvConfig().leg_contact is None


@pytest.mark.slow
def test_the_shipped_policies_enter_every_state_from_every_other() -> None:
    options = transitions.Options(episodes=4, controllers=("policy",), threads=1)
    rows = run_transitions(options, cache=None, progress=False)["rows"]
    assert {(r["from"], r["to"]) for r in rows} == {
        ("walk", "stand"),
        ("sit", "stand"),
        ("stand", "walk"),
        ("stand", "sit"),
    }
    for row in rows:
        # A policy that was not trained to enter its state is not asked to live: the PD does.
        if Policy.load(row["to"]).manifest.get("transitions", False):
            assert row["success_time_ratio"] > 0.5
