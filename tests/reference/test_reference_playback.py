"""References in the simulator: the joints sent straight to the PD keep the robot up."""

import numpy as np
import pytest

from studio import geometry
from studio.reference import stances
from studio.reference.library import TASKS
from studio.reference.marching import Bout, march_track
from studio.reference.realize import realize
from studio.sim.world import World


def play(world, motion):
    """Simulated base positions (n, 3) and tilt errors (n,) deg until a fall or the end."""
    world.reset(motion.poses()[0])
    base, error = [], []
    for i in range(1, len(motion)):
        state = world.step(motion.joint_pos[i])
        ours = stances.tilt_of(motion.state, state.base_quat) * [1.0, 1.0, 0.0]
        theirs = stances.tilt_of(motion.state, motion.base_quat[i]) * [1.0, 1.0, 0.0]
        angle = geometry.quat_angle(geometry.quat_from_rpy(ours), geometry.quat_from_rpy(theirs))
        if state.trunk_contact or angle > np.radians(60.0):
            break
        base.append(state.base_pos)
        error.append(np.degrees(angle))
    return np.array(base), np.array(error)


@pytest.fixture(scope="module")
def world():
    return World()


def test_the_neutral_sit_stays_put_for_five_seconds(world):
    pose = stances.NEUTRAL["sit"]
    start = world.reset(pose).base_pos
    for i in range(180):
        state = world.step(pose.joint_pos)
        if i == 29:
            settled = state.base_pos
    assert not state.trunk_contact
    assert np.linalg.norm(state.base_pos - start) < 0.06  # the PD gives way, then holds
    assert np.linalg.norm(state.base_pos - settled) < 0.02


@pytest.mark.parametrize("name", list(TASKS))
def test_playing_a_task_keeps_the_robot_up(world, name):
    motion = realize(TASKS[name].sample(np.random.default_rng(3), 6.0))
    base, error = play(world, motion)
    assert len(base) == len(motion) - 1
    assert np.mean(error) < (12.0 if TASKS[name].state == "sit" else 6.0)


@pytest.mark.parametrize(("cadence", "lift", "share"), [(0.4, 0.7, 0.7), (0.8, 0.8, 0.85)])
def test_a_played_crawl_covers_most_of_its_way(world, cadence, lift, share):
    bout = Bout(half_strides=int(16 * cadence), cadence=cadence, lift=lift)
    motion = realize(march_track("walk", 8.0, [bout]))
    base, _ = play(world, motion)
    assert len(base) == len(motion) - 1
    assert base[-1, 0] - base[0, 0] > share * (motion.base_pos[-1, 0] - motion.base_pos[0, 0])


@pytest.mark.slow
@pytest.mark.parametrize("name", ["walk", "turn", "march", "sit_tilt", "tilt_manipulate"])
def test_playing_many_seeds_seldom_falls(world, name):
    motions = [realize(TASKS[name].sample(np.random.default_rng(s), 8.0)) for s in range(50, 70)]
    stood = [len(play(world, motion)[0]) == len(motion) - 1 for motion in motions]
    assert np.mean(stood) >= 0.9
