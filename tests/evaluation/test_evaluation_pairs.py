"""The pairs table: figures by hand, and the experts before the baselines."""

import numpy as np
import pytest

from studio.evaluation.pairs import run_pairs, switches
from studio.retarget.baselines.base import Targets, unstack
from studio.retarget.baselines.foot_height import contact_by_height
from studio.retarget.baselines.nearest import NearestPair
from studio.retarget.baselines.ridge import Ridge
from studio.robot import a1, kinematics


def linear_pairs(n: int = 400) -> tuple[np.ndarray, Targets]:
    """Triplets of 6 numbers and targets that are a linear function of them."""
    rng = np.random.default_rng(0)
    x = rng.normal(size=(n, 6))
    joints = a1.STAND_JOINT_POS + 0.05 * x @ rng.normal(size=(6, 12))
    quat = np.tile([1.0, 0.0, 0.0, 0.0], (n, 1))
    rates = x @ rng.normal(size=(6, 36))
    return x, Targets(joint_pos=joints, base_quat=quat, rates=rates, contact=np.ones((n, 4)))


def test_ridge_finds_a_linear_map():
    x, targets = linear_pairs()
    found = Ridge(x[:300], targets_of(targets, slice(300)), penalty=1e-9)(x[300:])
    np.testing.assert_allclose(found.joint_pos, targets.joint_pos[300:], atol=1e-5)
    np.testing.assert_allclose(found.rates, targets.rates[300:], atol=1e-4)


def test_nearest_pair_gives_back_what_it_was_shown():
    x, targets = linear_pairs()
    found = NearestPair(x, targets)(x[::7] + 1e-4)
    np.testing.assert_allclose(found.joint_pos, targets.joint_pos[::7])


def targets_of(targets: Targets, rows: slice) -> Targets:
    return Targets(**{f: getattr(targets, f)[rows] for f in Targets.__dataclass_fields__})


def test_estimates_are_held_to_what_a_robot_can_be():
    rows = np.full((1, 56), 9.0)
    mapped = unstack(rows)
    np.testing.assert_allclose(mapped.joint_pos[0], a1.JOINT_UPPER)
    np.testing.assert_allclose(np.linalg.norm(mapped.base_quat), 1.0)
    np.testing.assert_allclose(mapped.contact_prob, 1.0)


def test_contact_by_height_sees_the_raised_paw():
    foot = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    foot[1, 2] += 0.03
    joints = kinematics.leg_ik(foot)[0]
    contact = contact_by_height(np.array([[1.0, 0.0, 0.0, 0.0]]), joints[None])
    np.testing.assert_array_equal(contact, [[1.0, 0.0, 1.0, 1.0]])


def test_switches_are_counted_per_second_and_foot():
    # One foot of four goes up and down once in a second: two switches, a half on average.
    contact = np.ones((30, 4))
    contact[10:20, 0] = 0.0
    assert switches(contact) == pytest.approx(0.5)


@pytest.mark.slow
def test_the_shipped_experts_beat_nearest_pair_and_ridge_on_strangers():
    rows = run_pairs(episodes=6, train_seconds=120.0)["rows"]
    by = {(row["state"], row["case"]): row for row in rows}
    for state in ("stand", "walk"):
        expert = by[state, "expert"]
        for other in ("nearest_pair", "ridge"):
            assert expert["joint_rmse_deg"] < by[state, other]["joint_rmse_deg"], (state, other)
        assert expert["foot_skate_m_s"] < 0.5 * expert["foot_skate_without_m_s"]
        height = by[state, "expert, contact by foot height"]
        assert expert["contact_f1"] > height["contact_f1"]
