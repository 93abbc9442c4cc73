"""The rows of the policy tables: trained ones where there are weights, each on its own terms."""

from pathlib import Path

import numpy as np
import pytest

from studio.evaluation.contenders import contender, trained
from studio.evaluation.transitions import crossings_from, run_transitions
from studio.imitation.bank import build_bank
from studio.imitation.env import EnvConfig
from studio.imitation.policy import Policy, save_policy
from studio.training.policy import PolicyTrainer
from studio.training.policy_settings import PolicyTraining, Recipe, make_environment
from studio.training.ppo import PpoConfig
from studio.training.variants import VARIANTS, Variant, settings_of, weights

TINY = {"num_envs": 4, "threads": 1, "motions_per_task": 1, "crossings": 0}


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
    save_untrained(path, "sit", future="true")
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
    full = settings_of(Variant(state="walk", name="full"))
    for name in VARIANTS:
        config = settings_of(Variant(state="walk", name=name))
        changed = [
            key
            for key in vars(config)
            if key != "run" and getattr(config, key) != getattr(full, key)
        ]
        assert len(changed) <= 2, name
        assert config.samples == 3_000_000


def test_crossings_are_judged_from_their_first_frame() -> None:
    bank = crossings_from("sit")("stand", 2, 3)
    assert (len(bank), bank.frames, bank.tasks) == (2, 301, ("from_sit",))
    assert bank.leg_contact
    assert EnvConfig().leg_contact is None


@pytest.mark.slow
def test_the_shipped_policies_enter_every_state_from_every_other() -> None:
    settings = {"controllers": ("policy",), "threads": 1, "cache": None, "progress": False}
    rows = run_transitions(4, **settings)["rows"]  # type: ignore[arg-type]
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
