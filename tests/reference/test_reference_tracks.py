"""Key-pose tracks and marches: timing, limits, and phases that are the integral of the cadence."""

import numpy as np
import pytest

from studio.geometry.time_scaling import minimum_jerk
from studio.reference import gait
from studio.reference.keyframes import Goal, keyframe_track
from studio.reference.marching import Bout, march_track
from studio.reference.realize import realize
from studio.reference.stances import JOINT_SPEED
from studio.reference.tracks import make_track


def test_minimum_jerk_rests_at_both_ends_and_is_half_way_in_the_middle():
    assert minimum_jerk(0.5) == pytest.approx(0.5)
    s = np.linspace(0.0, 1.0, 1001)
    speed = np.gradient(minimum_jerk(s), s)
    assert speed[0] < 1e-4
    assert np.max(speed) == pytest.approx(1.875, rel=1e-3)  # 30 s^2 - 60 s^3 + 30 s^4 at 1/2


def test_goals_too_far_for_the_joints_take_longer_or_come_nearer():
    def far(rng):
        return Goal(reach=np.array([1.0, 0.0]) * (rng.random() > 0.5))

    for seed in range(5):
        track = keyframe_track(np.random.default_rng(seed), "stand", "test", 12.0, far)
        assert np.max(np.abs(realize(track).joint_vel)) < JOINT_SPEED[track.state]
        assert np.max(track.reach) > 0.8


def test_tracks_start_at_rest_in_the_neutral_pose():
    track = keyframe_track(
        np.random.default_rng(0), "stand", "test", 3.0, lambda rng: Goal(tilt=np.full(3, 0.2))
    )
    assert np.all(track.tilt[0] == 0.0)
    assert len(track) == 90


def test_the_cadence_is_the_rate_of_the_phase_and_bouts_end_where_all_feet_stand():
    bouts = [
        Bout(half_strides=5, cadence=0.7, lift=0.8, pause=0.8),
        Bout(half_strides=4, cadence=1.6, lift=0.5, pause=0.5),
    ]
    track = march_track("march", 10.0, bouts)
    rate = np.gradient(track.phase, track.dt)
    error = rate - track.cadence
    assert np.mean(np.abs(error)) < 0.02
    assert track.phase[0] == gait.REST_PHASE
    assert track.phase[-1] == pytest.approx(gait.REST_PHASE + 4.5)
    assert track.cadence[-1] == track.speed[-1] == track.lift[-1] == 0.0
    assert np.all(np.diff(track.phase) >= -1e-12)


def test_a_short_bout_is_walked_with_smaller_steps():
    short = march_track("march", 4.0, [Bout(half_strides=1, cadence=1.5, lift=1.0)])
    long = march_track("march", 10.0, [Bout(half_strides=20, cadence=1.5, lift=1.0)])
    assert np.max(short.speed) < 0.6 * np.max(long.speed)
    assert np.max(long.speed) == pytest.approx(float(gait.speed_limit(1.5)), rel=1e-6)


def test_a_field_of_the_wrong_length_is_refused():
    with pytest.raises(AssertionError, match="speed"):
        make_track("walk", "test", 10, speed=np.zeros(9))
