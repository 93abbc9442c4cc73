"""Walking: feet that stand never slide, and the path is what speed and turn say."""

import numpy as np
import pytest

from studio.reference import gait, stances
from studio.reference.intent import Intent
from studio.reference.marching import Bout, march_track
from studio.reference.realize import realize
from studio.reference.walking import Walker
from studio.robot import a1, kinematics


def plan(track):
    walker = Walker()
    steps = [walker.step(track[i]) for i in range(len(track))]
    return tuple(np.array(v) for v in zip(*steps))


def straight(cadence, lift, seconds=8.0, turn=0.0):
    bout = Bout(half_strides=int(2 * seconds * cadence), cadence=cadence, lift=lift, turn=turn)
    return march_track("walk", seconds, [bout])


def test_without_a_march_the_robot_stands_in_its_neutral_pose():
    base, rpy, feet = Walker().step(Intent(state="walk"))
    np.testing.assert_allclose(base, [0.0, 0.0, a1.STAND_HEIGHT], atol=1e-9)
    np.testing.assert_allclose(rpy, 0.0)
    np.testing.assert_allclose(feet, stances.NEUTRAL_FEET["walk"], atol=1e-6)


@pytest.mark.parametrize("cadence", [0.3, 0.6, 1.0, 1.2, 1.5, 2.3])
def test_standing_feet_do_not_move_and_at_least_two_stand(cadence):
    feet = plan(straight(cadence, 0.7))[2]
    down = feet[:, :, 2] <= a1.FOOT_RADIUS + 1e-9
    stays = down[1:] & down[:-1]
    moved = np.linalg.norm(np.diff(feet[..., :2], axis=0), axis=-1)
    assert np.max(moved[stays]) < 1e-9
    assert np.min(np.sum(down, axis=-1)) >= 2
    if cadence <= 0.9:
        assert np.min(np.sum(down, axis=-1)) >= 3


@pytest.mark.parametrize("cadence", [0.4, 1.0, 1.5, 2.2])
def test_the_way_walked_is_the_integral_of_the_speed(cadence):
    track = straight(cadence, 0.6, seconds=10.0)
    base = plan(track)[0]
    asked = np.sum(track.speed) * track.dt
    assert base[-1, 0] - base[0, 0] == pytest.approx(asked, rel=0.06)


def test_the_top_speed_is_reached():
    base = plan(straight(2.1, 1.0, seconds=8.0))[0]
    speed = (base[210, 0] - base[120, 0]) / 3.0
    assert speed == pytest.approx(gait.MAX_SPEED, abs=0.01)


@pytest.mark.parametrize("degrees", [-15.0, 15.0])
def test_a_turn_follows_an_arc_at_fifteen_degrees_a_second(degrees):
    track = straight(1.5, 0.7, turn=np.radians(degrees))
    base, rpy, _ = plan(track)
    rate = (rpy[210, 2] - rpy[120, 2]) / 3.0
    assert np.degrees(rate) == pytest.approx(degrees, abs=0.5)
    # Radius = speed / rate: the chord of three seconds is 2 r sin(angle / 2).
    radius = np.mean(track.speed[120:210]) / abs(rate)
    chord = np.linalg.norm(base[210, :2] - base[120, :2])
    assert chord == pytest.approx(2.0 * radius * np.sin(1.5 * abs(rate)), rel=0.03)


def test_a_slow_march_is_held_to_the_longest_step():
    intents = [
        Intent(state="walk", speed=1.0, cadence=0.5, lift=0.5, phase=gait.REST_PHASE + 0.5 * t)
        for t in np.arange(0.0, 20.0, a1.CONTROL_DT)
    ]
    walker = Walker()
    base = np.array([walker.step(i)[0] for i in intents])
    speed = (base[-1, 0] - base[300, 0]) / (len(base) - 301) / a1.CONTROL_DT
    assert speed == pytest.approx(float(gait.speed_limit(0.5)), rel=0.05)


def test_a_pause_in_mid_march_stops_the_robot_where_it_is():
    bouts = [Bout(half_strides=4, cadence=0.8, lift=0.6, pause=1.5)] * 2
    track = march_track("march", 9.0, bouts)
    base, _, feet = plan(track)
    still = np.flatnonzero(track.cadence == 0.0)
    still = still[(still > 60) & (still < 200)]
    assert len(still) > 30
    inside = still[10:-5]
    assert np.ptp(base[inside, 0]) < 0.03
    assert np.max(feet[inside, :, 2]) <= a1.FOOT_RADIUS + 1e-9


def test_hostile_intents_give_finite_poses():
    rng = np.random.default_rng(5)
    walker = Walker()
    for _ in range(300):
        intent = Intent(
            state="walk",
            tilt=rng.normal(0.0, 1.0, 3),
            crouch=rng.uniform(-1, 2),
            speed=rng.normal(0.0, 3.0),
            turn=rng.normal(0.0, 3.0),
            phase=rng.uniform(-5.0, 5.0),
            cadence=rng.uniform(-1.0, 9.0),
            lift=rng.uniform(-1.0, 2.0),
        )
        assert all(np.all(np.isfinite(v)) for v in walker.step(intent))


def test_legs_reach_every_planned_foot():
    track = straight(2.0, 1.0)
    feet = plan(track)[2]
    motion = realize(track)
    reached = kinematics.foot_pos_w(motion.base_pos, motion.base_quat, motion.joint_pos)
    np.testing.assert_allclose(reached, feet, atol=1e-6)
