"""Foreseeing a reference from its past: where it can be known, and better than holding still."""

import numpy as np
import pytest

from studio.control.observation import MEMORY, REFERENCE_DIM, History, ObservationConfig
from studio.errors import StudioError
from studio.rl import foresight
from studio.rl.bank import build_bank
from studio.rl.noise import NoiseConfig

AHEAD = (3, 6)
CALM = NoiseConfig(joint_sigma=(0.0, np.deg2rad(0.5)), repeat=(0.0, 0.0))


def test_a_gait_is_foreseen_better_than_by_holding_its_last_pose() -> None:
    bank = build_bank("walk", per_task=4, seconds=5.0, difficulties=(1.0,))
    foresee = foresight.fit(bank, AHEAD, CALM, np.random.default_rng(0), samples=8_000)
    held_out = build_bank("walk", per_task=1, seconds=5.0, seed=9, difficulties=(1.0,))
    at = np.arange(60, 130)
    past = np.stack([held_out.feature[:, k - MEMORY + 1 : k + 1] for k in at])
    past = past.reshape(-1, MEMORY, REFERENCE_DIM)
    guess = foresee(past).reshape(-1, len(AHEAD), REFERENCE_DIM)
    for i, ahead in enumerate(AHEAD):
        truth = np.stack([held_out.feature[:, k + ahead] for k in at]).reshape(-1, REFERENCE_DIM)
        foreseen = np.sqrt(np.mean((guess[:, i, :12] - truth[:, :12]) ** 2))
        held = np.sqrt(np.mean((past[:, -1, :12] - truth[:, :12]) ** 2))
        assert foreseen < 0.7 * held


def test_a_reference_that_stands_still_is_foreseen_to_stand_still() -> None:
    bank = build_bank("stand", per_task=2, seconds=3.0, difficulties=(1.0,))
    foresee = foresight.fit(bank, AHEAD, CALM, np.random.default_rng(0), samples=5_000)
    still = np.tile(bank.feature[0, 0], (1, MEMORY, 1))
    guess = foresee(still).reshape(len(AHEAD), REFERENCE_DIM)
    assert np.abs(guess[:, :12] - still[0, -1, :12]).max() < np.radians(2.0)


def test_its_tensors_bring_it_back() -> None:
    bank = build_bank("sit", per_task=1, seconds=2.0, difficulties=(0.4,))
    foresee = foresight.fit(bank, AHEAD, CALM, np.random.default_rng(0), samples=500)
    again = foresight.Foresight.of(foresee.tensors())
    assert again is not None
    past = bank.feature[:1, :MEMORY]
    np.testing.assert_allclose(again(past), foresee(past), atol=1e-5)
    assert foresight.Foresight.of({}) is None


def test_the_observation_ends_with_the_future() -> None:
    config = ObservationConfig(future=AHEAD)
    history = History(2, config, lambda past: np.full((len(past), 2 * REFERENCE_DIM), 7.0))
    assert history.observation().shape == (2, config.dim)
    assert np.all(history.observation()[:, -2 * REFERENCE_DIM :] == 7.0)
    with pytest.raises(StudioError, match="predictor"):
        History(2, config)
