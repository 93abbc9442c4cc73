"""What the table of travelling measures, on motions whose answer is known."""

import numpy as np
import pytest

from studio.evaluation import travel
from studio.synthetic.travelling import STANDS_S, Travelling


def run(asked, done, apart=0.0, fell=False):
    asked, done = np.atleast_2d(asked).astype(float), np.atleast_2d(done).astype(float)
    return travel.Run(
        asked=asked, reference=asked, done=done, apart=np.full(len(asked), apart), fell=fell
    )


def test_a_row_says_how_far_speeds_are_off_and_which_turns_are_right():
    turn = np.radians(30.0)
    runs = [
        run([(0.5, 0.0, turn), (0.5, 0.0, -turn)], [(0.4, 0.0, turn), (0.3, 0.0, turn)], apart=0.1),
        run([(0.05, 0.0, 0.0)], [(0.9, 0.0, 0.0)], fell=True),  # too slow to be travelling
    ]
    row = travel._row("x", "synthetic", runs, 0)
    assert (row["windows"], row["turns"], row["fell"]) == (2, 2, 1)
    assert row["speed_error_m_s"] == pytest.approx(0.15)
    assert row["turn_sign_right"] == 0.5
    assert row["apart_m"] == pytest.approx(0.1)


def test_velocities_are_told_in_the_heading_of_whoever_goes():
    t = np.arange(61) / 30.0
    yaw = 0.5 * np.pi + 0.2 * t
    # Ahead at 0.6 m/s on an arc.
    way = np.cumsum(0.6 / 30.0 * np.stack([np.cos(yaw), np.sin(yaw)], axis=1), axis=0)
    place = np.column_stack([way, yaw])
    assert np.allclose(travel._velocity(place, 60), [0.6, 0.0, 0.2], atol=5e-3)
    aside = place.copy()
    aside[31:, 0] += 0.02  # to the right of who faces +y
    assert travel._apart(place, aside, 60) > 0.01


def test_the_synthetic_traveller_goes_as_told_and_the_same_way_for_a_seed():
    person = Travelling(3, np.array([0.5, -0.2, 0.0]))
    poses = {k: person.read(k / 30.0) for k in range(180)}
    seen = {k: pose.joint_pos_w for k, pose in poses.items() if pose is not None}
    way = (seen[179][0] - seen[120][0])[:2] / (59 / 30.0)
    assert np.allclose(way, [0.5, -0.2], atol=0.1)
    standing = [joints for k, joints in seen.items() if k < 30 * STANDS_S]
    assert np.ptp([joints[0, 0] for joints in standing]) < 0.1
    again = Travelling(5), Travelling(5)
    for k in range(200):
        ours, theirs = (each.read(k / 30.0) for each in again)
        assert (ours is None) == (theirs is None)
        if ours is not None and theirs is not None:
            assert np.array_equal(ours.joint_pos_w, theirs.joint_pos_w)


@pytest.mark.slow
def test_it_follows_somebody_ahead_and_back_in_physics():
    for name, sign in (("ahead .6", 1.0), ("back .2", -1.0)):
        velocity = np.array(travel.WAYS[name]) * travel.AT_PERSONS_SIZE * [1.0, 1.0, 0.0]
        done = travel.follow(travel._person(1, velocity), travel.PuppeteerConfig(seed=1))
        assert not done.fell
        assert len(done.done) > 4
        assert np.all(sign * done.done[:, 0] > 0.0)
