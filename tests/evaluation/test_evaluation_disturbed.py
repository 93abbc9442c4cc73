"""Disturbed references: the same disturbance whatever is done about it, and what each part does."""

import numpy as np
import pytest

from studio.evaluation.ablation import first
from studio.evaluation.disturbed import Disturbance, disturbed
from studio.rl.bank import MotionBank, build_bank
from studio.rl.env import ImitationEnv
from studio.rl.rollouts import evaluation_env
from studio.robot import a1

LIMIT = float(np.radians(120.0))


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("stand", per_task=1, seconds=3.0, difficulties=(1.0,))


def treated(
    bank: MotionBank, *, contact: bool, limit: float = np.inf, **noise: object
) -> MotionBank:
    rng = np.random.default_rng(5)
    return disturbed(bank, rng, contact=contact, speed_limit=limit, noise=Disturbance(**noise))  # type: ignore[arg-type]


def test_without_noise_an_untreated_reference_is_the_clean_one(bank: MotionBank) -> None:
    calm = treated(bank, contact=False, sigma=(0.0, 0.0), freeze=1e-6, contact_noise=0.0)
    assert calm.seen is not None
    np.testing.assert_allclose(calm.seen, bank.feature, atol=1e-6)


def test_the_noise_has_the_spread_asked_for(bank: MotionBank) -> None:
    shaken = treated(bank, contact=False, sigma=(0.05, 0.05), freeze=1e-6)
    error = (shaken.seen - bank.feature)[..., :12]  # type: ignore[operator]
    assert error.std() == pytest.approx(0.05, rel=0.1)


def test_temporal_consistency_keeps_joints_under_their_speed(bank: MotionBank) -> None:
    def fastest(b: MotionBank) -> float:
        assert b.seen is not None
        return float(np.abs(np.diff(b.seen[..., :12], axis=1)).max() / a1.CONTROL_DT)

    assert fastest(treated(bank, contact=False)) > 1.5 * LIMIT
    assert fastest(treated(bank, contact=False, limit=LIMIT)) <= LIMIT + 1e-6


def test_contact_consistency_keeps_standing_feet_where_they_are(bank: MotionBank) -> None:
    quiet = first(bank, 1)
    free = treated(quiet, contact=False, freeze=1e-6)
    held = treated(quiet, contact=True, freeze=1e-6)
    assert free.seen is not None
    assert held.seen is not None
    # Base height follows the feet that stand rather than its own noise.
    assert held.seen[0, 5:, :12].std(axis=0).mean() < free.seen[0, 5:, :12].std(axis=0).mean()


def test_the_environment_shows_what_is_seen_and_measures_against_the_clean(
    bank: MotionBank,
) -> None:
    shaken = treated(bank, contact=False)
    env: ImitationEnv = evaluation_env(shaken, len(bank), 0, threads=1)
    env.reset()
    assert shaken.seen is not None
    np.testing.assert_array_equal(env.noisy_joint_pos, shaken.seen[env.motion, env.frame, :12])
    env.step(np.zeros((len(bank), 12)))
    np.testing.assert_array_equal(env.noisy_joint_pos, shaken.seen[env.motion, env.frame, :12])
