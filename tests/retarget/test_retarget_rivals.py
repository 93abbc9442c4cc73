"""The rivals: each in an expert's place by the same protocol, each with what it must refuse."""

from functools import cache

import numpy as np
import pytest
from scipy.optimize import check_grad

from studio import geometry
from studio.errors import StudioError
from studio.human.features import FEATURE_DIM, FEATURE_NAMES
from studio.reference.intent import STATES, StateName
from studio.retarget.baselines import dontcheva2003, gmr, kim2020, yamane2010
from studio.retarget.baselines.frames import Targets
from studio.retarget.baselines.moving import Moving, pose_rows
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.mapper import RATES, Expert
from studio.robot import a1, kinematics
from studio.training import rivals
from studio.training.operator_pairs import PairSet
from studio.training.synthetic_pairs import make_pairs

CYCLIC = "kim2020"
MAPS_ALL = [name for name in RIVALS if name != CYCLIC]
PLACES = [*((name, state) for name in MAPS_ALL for state in STATES), (CYCLIC, "walk")]


@cache
def pairs_of(state: StateName) -> PairSet:
    return make_pairs(state, 60.0, 0)


@cache
def crowd(state: StateName) -> list[PairSet]:
    pairs = make_pairs(state, 50.0, 20_000, family="held_out")
    return [pairs.take(pairs.clip == c) for c in np.unique(pairs.clip)]


def strangers(state: StateName) -> PairSet:
    return crowd(state)[0]


@cache
def fitted(name: str, state: StateName) -> Expert:
    return rivals.fitted(name, state, pairs_of(state), seed=0)


@pytest.mark.parametrize(("name", "state"), PLACES)
def test_a_rival_takes_an_experts_place(name: str, state: StateName) -> None:
    expert, triplet = fitted(name, state), strangers(state).triplet
    batch = expert(triplet)
    frames = len(triplet)
    assert batch.joint_pos.shape == (frames, 12)
    assert batch.base_quat.shape == (frames, 4)
    assert batch.rates.shape == (frames, 36)
    assert batch.contact_prob.shape == (frames, 4)
    for value in (batch.joint_pos, batch.base_quat, batch.rates, batch.contact_prob):
        assert np.isfinite(value).all()
    assert (batch.joint_pos >= a1.JOINT_LOWER - 1e-9).all()
    assert (batch.joint_pos <= a1.JOINT_UPPER + 1e-9).all()
    np.testing.assert_allclose(np.linalg.norm(batch.base_quat, axis=1), 1.0, atol=1e-6)
    assert ((batch.contact_prob >= 0.0) & (batch.contact_prob <= 1.0)).all()
    # Live, a frame at a time, it says the same, and again the same when it begins anew.
    for _ in range(2):
        begun = expert.begin()
        live = [begun(row) for row in triplet[:20]]
        np.testing.assert_allclose([m.joint_pos for m in live], batch.joint_pos[:20], atol=1e-6)
        np.testing.assert_allclose([m.rates for m in live], batch.rates[:20], atol=1e-4)


LEARNT = [
    (name, state)
    for name, state in PLACES
    if name not in ("stand_still", "gmr")
    # Of so few pairs; poses without velocities do not tell a march's directions from any number.
    and (name, state) not in [("ridge", "walk"), ("yamane2010", "walk"), ("yamane2010", "stand")]
]


@pytest.mark.parametrize(("name", "state"), LEARNT)
def test_what_is_learnt_beats_doing_nothing_on_strangers(name: str, state: StateName) -> None:
    def error(which: str) -> float:
        expert = fitted(which, state)
        squares = [(expert(c.triplet).joint_pos - c.joint_pos) ** 2 for c in crowd(state)]
        return float(np.sqrt(np.mean(np.concatenate(squares))))

    assert error(name) < error("stand_still")


@pytest.mark.parametrize("state", ["stand", "sit"])
def test_who_maps_cycles_refuses_those_who_make_none_and_says_what_would_work(state) -> None:
    with pytest.raises(StudioError, match=r"--state walk.*yamane2010"):
        rivals.fitted(CYCLIC, state, pairs_of(state))


def test_an_unknown_rival_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StudioError, match="seol2013"):
        rivals.fitted("merlin", "walk", pairs_of("walk"))


def test_every_rival_says_where_it_is_from_and_where_it_ends() -> None:
    for module in (dontcheva2003, gmr, kim2020, yamane2010):
        assert module.__doc__
        for word in ("Source:", "Kept:", "Input:", "Limits:"):
            assert word in module.__doc__, (module.__name__, word)


def test_the_cyclic_rival_keeps_time_in_the_plane() -> None:
    expert, held = fitted(CYCLIC, "walk"), strangers("walk")
    said = expert(held.triplet)
    assert np.abs(said.joint_pos[:, 0::3]).max() == 0.0
    np.testing.assert_allclose(geometry.quat_to_rpy(said.base_quat)[:, [0, 2]], 0.0, atol=1e-9)
    # Somebody who stands makes no step.
    still = np.zeros((60, 3 * FEATURE_DIM))
    still[:, :FEATURE_DIM] = held.triplet[:, :FEATURE_DIM].mean(axis=0)
    assert np.ptp(expert(still).joint_pos[-10:], axis=0).max() < 1e-6


@pytest.mark.parametrize("hertz", [0.5, 1.0, 2.0])
def test_a_cycle_is_read_with_its_phase_and_frequency(hertz: float) -> None:
    cycle, omega = kim2020.Cycle(), 2.0 * np.pi * hertz
    for k in range(kim2020.WINDOW * 4):
        phase = omega * k * a1.CONTROL_DT
        cycle.step(0.3 + 0.1 * np.cos(phase), -0.1 * omega * np.sin(phase))
    assert cycle.frequency == pytest.approx(hertz, rel=0.2)
    assert cycle.amplitude == pytest.approx(0.1, rel=0.2)
    assert abs(geometry.wrap_angle(cycle.phase - phase)) < 0.4


def test_the_likelihood_of_the_shared_latents_has_the_gradient_that_it_says() -> None:
    rng = np.random.default_rng(0)
    grams = [y @ y.T / y.shape[1] for y in (rng.normal(size=(12, 9)), rng.normal(size=(12, 5)))]
    at, shape = 0.5 * rng.normal(size=12 * 3 + 4), (12, 3)
    off = check_grad(
        lambda v: yamane2010._cost(v, grams, shape)[0],
        lambda v: yamane2010._cost(v, grams, shape)[1],
        at,
    )
    assert off < 1e-4


def test_a_shared_latent_gives_its_key_poses_back() -> None:
    rng = np.random.default_rng(1)
    hidden = rng.normal(size=(30, 2))
    human = np.tanh(hidden @ rng.normal(size=(2, 12)))
    robot = 0.3 * hidden @ rng.normal(size=(2, 15))
    latent = yamane2010.shared_latent(human, robot)
    said = np.array([latent.pose(latent.explain(latent.start(z), z)) for z in human])
    assert np.sqrt(np.mean((said - robot) ** 2)) < 0.5 * robot.std()


def test_key_poses_are_far_apart() -> None:
    rows = np.concatenate([np.zeros((50, 15)), np.ones((1, 15)), -np.ones((1, 15))])
    assert {*yamane2010.key_frames(rows, 3, seed=0).tolist()} >= {50, 51}


@pytest.mark.parametrize("late", [-6, 0, 6])
def test_warping_finds_by_how_much_a_mimic_is_late(late: int) -> None:
    t = np.arange(120)
    robot = np.stack([np.sin(0.15 * t), np.cos(0.11 * t)], axis=1)
    at = dontcheva2003.warp(np.roll(robot, late, axis=0), robot)
    assert (np.diff(at) >= 0).all()
    np.testing.assert_array_equal(at[30:90], t[30:90] + late)


def test_canonical_variates_find_what_two_sides_share() -> None:
    rng = np.random.default_rng(2)
    shared = rng.normal(size=400)
    x, y = rng.normal(size=(400, 5)), rng.normal(size=(400, 3))
    x[:, 3] = shared + 0.1 * x[:, 3]
    y[:, 1] = -shared
    to_x, to_y, correlation = dontcheva2003.cca(x, y)
    assert correlation[0] > 0.95
    assert abs(np.corrcoef(x @ to_x[:, 0], y @ to_y[:, 0])[0, 1]) > 0.95


def test_a_raised_hand_is_a_raised_paw_of_the_same_side_by_inverse_kinematics() -> None:
    expert = fitted("gmr", "stand")
    rest = np.concatenate([expert.rest, np.zeros(2 * FEATURE_DIM)])  # type: ignore[attr-defined]
    raised = rest.copy()
    raised[FEATURE_NAMES.index("r_wrist.z")] += 0.3
    begun = expert.begin()
    before, after = (
        kinematics.foot_pos_b([begun(row).joint_pos for _ in range(10)][-1])[:, 2]
        for row in (rest, raised)
    )
    up = after - before
    assert up[0] > 0.08
    assert np.abs(up[1:]).max() < 0.05


def test_poses_alone_tell_contacts_and_the_way_that_standing_feet_make() -> None:
    moving = Moving("walk")
    home = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    for k in range(6):
        feet = home - [0.01 * k, 0.0, 0.0]
        feet[1] = home[1] + [0.0, 0.0, 0.05]
        said = moving.step(np.append(kinematics.leg_ik(feet)[0], np.zeros(3)))
    np.testing.assert_array_equal(said.contact_prob, [1.0, 0.0, 1.0, 1.0])
    forward = said.rates[RATES["base_lin_vel"]]
    np.testing.assert_allclose(forward, [0.01 / a1.CONTROL_DT, 0.0, 0.0], atol=1e-3)


def test_poses_as_rows_are_the_labels() -> None:
    pairs = pairs_of("sit")
    rows = pose_rows("sit", pairs)
    np.testing.assert_allclose(rows[:, :12], pairs.joint_pos, atol=1e-6)
    said = Moving("sit").step(rows[5])
    assert geometry.quat_angle(said.base_quat, pairs.base_quat[5]) < 1e-3
    assert Targets.of(pairs).stacked().shape == (len(pairs), 56)
