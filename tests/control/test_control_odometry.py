"""Heading and place, held by gyro and legs: against hand-computed steps and a real simulation."""

from collections.abc import Callable

import numpy as np
import pytest

from studio import geometry
from studio.control import odometry
from studio.control.observation import (
    GYRO_YAW,
    HEADING_CLIP,
    PLACE_CLIP,
    VELOCITY,
    YAW_RATE,
    History,
    ObservationConfig,
)
from studio.control.observation_frame import roll_pitch
from studio.errors import StudioError
from studio.evaluation.scripted import record
from studio.geometry import turn_xy
from studio.reference import gait
from studio.reference.marching import Bout, march_track
from studio.robot import a1, kinematics

DT = a1.CONTROL_DT
STANDING = np.ones((1, 4))
NO_CHANGE = (0.0, 0.0, 0.0)


def frames(yaw_rate: float = 0.0, forward: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A standing robot's z, and a reference that asks for a yaw rate and a speed."""
    z, p = np.zeros((1, 17)), np.zeros((1, 18))
    z[:, :12] = p[:, :12] = a1.STAND_JOINT_POS
    p[0, YAW_RATE], p[0, VELOCITY] = yaw_rate, (forward, 0.0)
    return z, p


def test_level_feet_undo_roll_and_pitch() -> None:
    roll, pitch = np.array([0.2]), np.array([-0.3])
    feet = odometry.level_feet(a1.STAND_JOINT_POS[None], roll, pitch)[0]
    cr, sr, cp, sp = np.cos(0.2), np.sin(0.2), np.cos(-0.3), np.sin(-0.3)
    turn = np.array([[cp, 0, sp], [0, 1, 0], [-sp, 0, cp]]) @ np.array(
        [[1, 0, 0], [0, cr, -sr], [0, sr, cr]]
    )
    np.testing.assert_allclose(feet, kinematics.foot_pos_b(a1.STAND_JOINT_POS) @ turn.T, atol=1e-12)


def test_a_trunk_that_moves_over_planted_feet_is_seen_to_move() -> None:
    rng = np.random.default_rng(0)
    planted = rng.standard_normal((5, 4, 3))
    turn, way = rng.uniform(-0.2, 0.2, 5), rng.standard_normal((5, 2))
    # Before: trunk at the origin, heading 0. Now: moved by `way` (in the new heading) and turned.
    gone = turn_xy(way, turn)
    now = planted.copy()
    now[..., :2] = turn_xy(planted[..., :2] - gone[:, None], -turn[:, None])
    stands = np.tile([1.0, 0.0, 1.0, 0.0], (5, 1))
    now[:, 1] += 0.3  # a swinging foot says nothing
    np.testing.assert_allclose(odometry.displacement(planted, now, turn, stands), way, atol=1e-12)
    assert not odometry.displacement(planted, now, turn, 0 * stands).any()


def placed(
    feet: Callable[..., np.ndarray], change: tuple[float, float, float], pitch: float = 0.0
) -> np.ndarray:
    """Feet of a standing robot whose hips, thighs and calves have turned by `change`."""
    joint_pos = a1.STAND_JOINT_POS + np.tile(change, 4)
    return feet(joint_pos[None], np.zeros(1), np.array([pitch]))


def test_a_foot_that_rolls_forward_over_its_contact_stays_where_it_is() -> None:
    # The leg swings back by 0.15 and the trunk tips forward by 0.1 over one foot.
    change, tips = (0.0, 0.2, -0.05), 0.1
    stands = np.array([[1.0, 0.0, 0.0, 0.0]])
    way = (placed(odometry.level_feet, NO_CHANGE) - placed(odometry.level_feet, change, tips))[0, 0]
    # A ball that turns forward by an angle rolls forward by its radius times the angle.
    way[0] += a1.FOOT_RADIUS * (0.2 - 0.05 + tips)
    before, now = placed(odometry.footholds, NO_CHANGE), placed(odometry.footholds, change, tips)
    seen = odometry.displacement(before, now, np.zeros(1), stands)
    assert way[0] > 0.05
    np.testing.assert_allclose(seen[0], way[:2], atol=1e-12)


def test_a_foot_that_rolls_sideways_over_its_contact_stays_where_it_is() -> None:
    # All hips turn the feet to the left, so that the level trunk moves to the right.
    change = (0.1, 0.0, 0.0)
    way = placed(odometry.level_feet, NO_CHANGE) - placed(odometry.level_feet, change)
    # Turned about x, the balls roll to the right, as the trunk moves.
    expected = way[0, :, 1].mean() - 0.1 * a1.FOOT_RADIUS
    before, now = placed(odometry.footholds, NO_CHANGE), placed(odometry.footholds, change)
    seen = odometry.displacement(before, now, np.zeros(1), STANDING)
    assert expected < -0.02
    np.testing.assert_allclose(seen[0], [0.0, expected], atol=1e-12)


def test_one_foot_of_three_that_slides_is_left_out() -> None:
    before = np.zeros((1, 4, 3))
    now = before - [0.01, 0.002, 0.0]
    now[0, 1, :2] -= [0.02, -0.01]
    stands = np.array([[1.0, 1.0, 1.0, 0.0]])
    seen = odometry.displacement(before, now, np.zeros(1), stands)
    np.testing.assert_allclose(seen, [[0.01, 0.002]], atol=1e-12)


def test_legs_tell_how_far_the_simulated_robot_walks() -> None:
    speed, seconds = 0.4, 5.0
    bout = Bout(half_strides=15, cadence=1.5, lift=float(gait.march_lift(1.5, speed)))
    done = record("walk", [march_track("walk", seconds, [bout])], "policy")
    pos, quat, joints = done.base_pos[:, 0], done.base_quat[:, 0], done.joint_pos[:, 0]
    height = kinematics.foot_pos_w(pos, quat, joints)[..., 2]
    stood = (height < a1.FOOT_RADIUS + odometry.CONTACT_GAP).astype(float)
    tilt = roll_pitch(quat)
    turn = np.diff(np.unwrap(geometry.heading(quat)))

    def way(feet: Callable[..., np.ndarray]) -> float:
        at = feet(joints, tilt[:, 0], tilt[:, 1])
        return float(
            odometry.displacement(at[:-1], at[1:], turn, stood[:-1] * stood[1:])[:, 0].sum()
        )

    true = turn_xy(np.diff(pos[:, :2], axis=0), -geometry.heading(quat)[1:])[:, 0].sum()
    assert true > 1.2
    assert way(odometry.footholds) == pytest.approx(true, rel=0.03)
    assert way(odometry.level_feet) < 0.96 * true  # what fixed centres would miss


def test_a_heading_that_is_missed_is_added_to_the_yaw_rate() -> None:
    history = History(1, ObservationConfig(heading_gain=2.0, hold_tau=5.0))
    z, p = frames(yaw_rate=0.3)
    z[0, GYRO_YAW] = 0.1
    history.reset(slice(None), z, p, STANDING)
    history.push(z, p, STANDING)
    # missed (0.3 - 0.1) / 30 rad, forgotten by 1/150; shown: 0.3 + 2 of it
    error = (0.3 - 0.1) * DT * (1.0 - DT / 5.0)
    assert history.heading_error[0] == pytest.approx(error)
    assert history.reference[0, -1, YAW_RATE] == pytest.approx(0.3 + 2.0 * error)
    assert history.reference[0, -2, YAW_RATE] == 0.3  # the past stays as it was


def test_a_trunk_that_yaws_within_its_stride_hardly_steers_while_a_missed_turn_does() -> None:
    def steering(smooth: float, gyro: np.ndarray) -> np.ndarray:
        config = ObservationConfig(heading_gain=1.0, heading_smooth=smooth, hold_tau=1e9)
        history, shown = History(1, config), []
        z, p = frames()
        history.reset(slice(None), z, p, STANDING)
        for rate in gyro:
            z[0, GYRO_YAW] = rate
            history.push(z, p, STANDING)
            shown.append(history.reference[0, -1, YAW_RATE])
        return np.array(shown)

    stride = np.cos(2.0 * np.pi * 2.0 * DT * np.arange(120))  # 2 Hz, 1 rad/s
    swing = [np.ptp(steering(smooth, stride)[60:]) for smooth in (0.0, 1.0)]
    # A first-order mean over 1 s passes 1 / |1 + 2 pi 2 i| = 1 / 12.6 of it.
    assert swing[1] / swing[0] == pytest.approx(1.0 / 12.6, rel=0.15)
    turned_away = np.zeros(150)
    turned_away[:30] = 0.2  # 0.2 rad off after a second, then straight on
    assert steering(1.0, turned_away)[-1] == pytest.approx(-0.2, rel=0.05)


def test_way_that_is_missed_is_added_to_the_velocity_in_the_robots_heading() -> None:
    history = History(1, ObservationConfig(heading_gain=1.0, place_gain=1.0))
    z, p = frames(yaw_rate=0.0, forward=0.6)
    history.reset(slice(None), z, p, STANDING)
    history.heading_error[:] = np.pi / 6 / (1.0 - DT / 5.0)  # it faces 30 degrees to the right
    history.push(z, p, STANDING)
    asked = 0.6 * DT * (1.0 - DT / 5.0)
    heading = min(np.pi / 6, HEADING_CLIP)
    expected = asked * np.array([np.cos(heading), np.sin(heading)])
    np.testing.assert_allclose(history.place_error[0], expected, atol=1e-12)
    np.testing.assert_allclose(history.reference[0, -1, VELOCITY], [0.6 + expected[0], expected[1]])


def test_errors_are_bounded_and_forgotten_by_a_reset() -> None:
    history = History(1, ObservationConfig(heading_gain=1.0, place_gain=1.0))
    z, p = frames(yaw_rate=1.0, forward=2.0)
    history.reset(slice(None), z, p, STANDING)
    for _ in range(60):
        history.push(z, p, STANDING)
    assert history.heading_error[0] == pytest.approx(HEADING_CLIP)
    assert np.hypot(*history.place_error[0]) == pytest.approx(PLACE_CLIP)
    history.reset(slice(None), z, p, STANDING)
    assert not history.heading_error.any()
    assert not history.place_error.any()


def test_nothing_is_held_by_default() -> None:
    history = History(1, ObservationConfig())
    z, p = frames(yaw_rate=1.0, forward=1.0)
    history.reset(slice(None), z, p, STANDING)
    history.push(z, p, STANDING)
    np.testing.assert_array_equal(history.reference[0], np.tile(p, (4, 1)))


def test_holding_without_a_gyro_is_refused() -> None:
    with pytest.raises(StudioError, match="yaw rate"):
        ObservationConfig(yaw_rate=False, heading_gain=1.0)
