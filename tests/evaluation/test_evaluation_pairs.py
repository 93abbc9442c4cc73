"""The pairs table: figures by hand, and the experts before the baselines."""

import numpy as np
import pytest

from studio.evaluation.pair_methods import SIZES, spread, widened
from studio.evaluation.pairs import Options, run_pairs, switches
from studio.evaluation.pairs_report import table
from studio.retarget.baselines.frames import Targets, unstack
from studio.retarget.baselines.simple import NearestPair, Ridge, contact_by_height
from studio.robot import a1, kinematics
from studio.training.synthetic_pairs import make_pairs


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


def test_the_monolithic_network_has_the_weights_of_three_experts():
    assert widened(20, 2, 10, 4, 1) == 20
    h = widened(128, 3, 165, 52, 3)

    def weights(h: int) -> int:
        return 165 * h + h + 2 * (h * h + h) + 52 * h + 52

    assert weights(h) == pytest.approx(3 * weights(128), rel=0.01)


def test_few_pairs_are_spread_over_all_performances():
    pairs = make_pairs("stand", 30.0, 0)
    few = spread(pairs, 76)
    assert len(few) == 76
    assert set(few.clip) == set(pairs.clip)
    assert spread(pairs, None) is pairs


def test_the_table_of_several_seeds_has_a_line_per_state_and_case():
    figures = {
        "orientation_error_deg": 2.0,
        "foot_error_m": 0.012,
        "foot_skate_m_s": 0.001,
        "contact_f1": 0.9,
        "fit_seconds": 3.0,
        "pairs": 76,
        "commit": "abc",
        "state": "walk",
        "case": "nearest_pair, 76 pairs",
    }
    rows = [{**figures, "seed": s, "joint_rmse_deg": 5.0 + 2.0 * s} for s in (0, 1)]
    assert table(rows).splitlines()[-1] == (
        "| walk | nearest pair | 76 | 6.0 ± 1.0 | 2.0 | 1.2 | 0.001 | 0.900 | 3.0 |"
    )


@pytest.mark.slow
@pytest.mark.long
@pytest.mark.timeout(900)  # it fits many mappers
def test_more_pairs_map_better_and_the_shipped_experts_beat_the_baselines_on_strangers():
    options = Options(
        episodes=6, train_seconds=120.0, steps=400, sizes=SIZES[::2], states=("stand", "walk")
    )
    rows = run_pairs(options)["rows"]
    by = {(row["state"], row["case"]): row for row in rows}
    said = ["76 pairs", "522 pairs", "all pairs"]
    for state in ("stand", "walk"):
        shipped = by[state, "expert"]
        for other in ("nearest_pair", "ridge", "expert", "monolithic"):
            error = [by[state, f"{other}, {n}"]["joint_rmse_deg"] for n in said]
            assert error[-1] < error[0], (state, other)
            assert shipped["joint_rmse_deg"] < error[-1], (state, other)
        assert by[state, "monolithic, 522 pairs"]["pairs"] == 2 * 522
        assert shipped["foot_skate_m_s"] < 0.5 * shipped["foot_skate_without_m_s"]
        height = by[state, "expert, contact by foot height"]
        assert shipped["contact_f1"] > height["contact_f1"]
