"""Every task of the library: fit to be tracked at any difficulty, and as wide as the paper's."""

import numpy as np
import pytest

from studio.reference import gait
from studio.reference.check import check
from studio.reference.intent import STATES
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.robot import kinematics

STAND = {"quiet", "tilt", "crouch", "manipulate_right", "manipulate_left", "tilt_manipulate"}


def problems_of(name, seed, difficulty, seconds=6.0):
    track = TASKS[name].sample(np.random.default_rng(seed), seconds, difficulty)
    return [f"{name} seed {seed} difficulty {difficulty}: {p}" for p in check(realize(track))]


def test_every_state_has_tasks_and_every_task_its_own_name():
    assert {task.state for task in TASKS.values()} == set(STATES)
    assert all(name == task.name for name, task in TASKS.items())
    assert {n for n, t in TASKS.items() if t.state == "stand"} == STAND


@pytest.mark.parametrize("name", list(TASKS))
def test_tasks_draw_the_frames_asked_for_and_the_same_from_the_same_seed(name):
    a, b = (TASKS[name].sample(np.random.default_rng(7), 4.0, 0.5) for _ in range(2))
    assert len(a) == 120
    assert a.state == TASKS[name].state
    assert a.task == name
    for field in ("tilt", "crouch", "reach", "speed", "phase", "lift"):
        np.testing.assert_array_equal(getattr(a, field), getattr(b, field))


@pytest.mark.parametrize("name", list(TASKS))
def test_tasks_are_fit_to_be_tracked(name):
    found = [p for seed in range(3) for d in (0.0, 1.0) for p in problems_of(name, seed, d)]
    assert found == []


@pytest.mark.slow
@pytest.mark.parametrize("name", list(TASKS))
def test_tasks_are_fit_to_be_tracked_over_many_seeds(name):
    found = [p for seed in range(100, 140) for p in problems_of(name, seed, 1.0, 8.0)]
    found += [p for seed in range(100, 120) for p in problems_of(name, seed, 0.4, 8.0)]
    assert found == []


@pytest.mark.parametrize("name", ["tilt", "walk", "sit_tilt"])
def test_a_higher_difficulty_asks_for_more(name):
    def size(difficulty):
        tracks = [TASKS[name].sample(np.random.default_rng(s), 5.0, difficulty) for s in range(20)]
        return np.mean([np.max(np.abs(t.tilt)) + np.max(t.speed) for t in tracks])

    assert size(1.0) > 1.5 * size(0.0)


def test_tilts_come_near_forty_degrees_on_every_axis():
    tracks = [TASKS["tilt"].sample(np.random.default_rng(s), 20.0) for s in range(30)]
    reach = np.degrees(np.max([np.max(np.abs(t.tilt), axis=0) for t in tracks], axis=0))
    assert np.all(reach > 36.0)
    assert np.all(reach < 40.1)


def test_walks_cover_the_speeds_and_turns_of_the_paper():
    walks = [TASKS["walk"].sample(np.random.default_rng(s), 5.0) for s in range(60)]
    speeds = np.array([np.max(t.speed) for t in walks])
    assert np.min(speeds) < 0.15
    assert np.max(speeds) > 0.9
    assert np.max(speeds) <= gait.MAX_SPEED + 1e-9
    turns = [TASKS["turn"].sample(np.random.default_rng(s), 8.0).turn for s in range(30)]
    assert np.degrees(np.max(turns)) > 13.0
    assert np.degrees(np.min(turns)) < -13.0
    assert np.max(np.abs(turns)) <= np.radians(15.0) + 1e-9


def test_marches_pause_and_start_again():
    track = TASKS["march"].sample(np.random.default_rng(1), 20.0)
    moving = track.cadence > 0.0
    assert np.sum(np.diff(moving.astype(int)) == 1) >= 2


@pytest.mark.parametrize(("name", "state_paw"), [("manipulate_right", 0), ("manipulate_left", 1)])
def test_manipulation_raises_its_own_paw(name, state_paw):
    motions = [realize(TASKS[name].sample(np.random.default_rng(s), 10.0)) for s in range(8)]
    feet = [kinematics.foot_pos_w(m.base_pos, m.base_quat, m.joint_pos)[..., 2] for m in motions]
    top = np.max([np.max(f, axis=0) for f in feet], axis=0)
    assert top[state_paw] > 0.25
    assert np.all(np.delete(top, state_paw) < 0.025)


def test_sitting_reaches_above_eighty_centimetres():
    motions = [
        realize(TASKS["sit_manipulate"].sample(np.random.default_rng(s), 10.0)) for s in range(8)
    ]
    feet = [kinematics.foot_pos_w(m.base_pos, m.base_quat, m.joint_pos)[..., 2] for m in motions]
    assert np.max([np.max(f) for f in feet]) > 0.8
