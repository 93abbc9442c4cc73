"""Realising intents: the same online and offline, fast, and where the robot is."""

import numpy as np
import pytest

from studio.reference import stances
from studio.reference.intent import Intent
from studio.reference.library import TASKS
from studio.reference.realize import Realizer, realize


@pytest.mark.parametrize("name", list(TASKS))
def test_steps_and_tracks_agree(name):
    track = TASKS[name].sample(np.random.default_rng(3), 3.0)
    motion, realizer = realize(track), Realizer()
    poses = [realizer.step(track[i]) for i in range(len(track))]
    for field in ("base_pos", "base_quat", "joint_pos"):
        online = np.stack([getattr(p, field) for p in poses])
        np.testing.assert_allclose(online, getattr(motion, field), atol=1e-9)
    rates = motion.poses()
    for i in range(2, len(track)):
        np.testing.assert_allclose(poses[i].joint_vel, rates[i].joint_vel, atol=1e-7)
        np.testing.assert_allclose(poses[i].base_lin_vel_w, rates[i].base_lin_vel_w, atol=1e-7)
        np.testing.assert_allclose(poses[i].base_ang_vel_b, rates[i].base_ang_vel_b, atol=1e-6)
        np.testing.assert_allclose(poses[i].foot_contact, motion.foot_contact[i], atol=1e-6)


def test_realising_is_deterministic():
    track = TASKS["march"].sample(np.random.default_rng(0), 4.0)
    np.testing.assert_array_equal(realize(track).joint_pos, realize(track).joint_pos)


def test_a_change_of_state_starts_where_the_robot_is():
    track = TASKS["turn"].sample(np.random.default_rng(1), 6.0)
    realizer = Realizer()
    for i in range(len(track)):
        last = realizer.step(track[i])
    sat = realizer.step(Intent(state="sit"))
    np.testing.assert_allclose(sat.base_pos[:2], last.base_pos[:2], atol=0.05)
    yaw = stances.tilt_of("walk", last.base_quat)[2]
    assert stances.tilt_of("sit", sat.base_quat)[2] == pytest.approx(yaw, abs=1e-6)
    assert np.all(sat.joint_vel == 0.0)
    realizer.reset()
    np.testing.assert_allclose(realizer.step(Intent()).base_pos[:2], 0.0, atol=1e-9)
