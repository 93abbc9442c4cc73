"""The gait: phases, duties, speeds, clearance and sway against figures worked out by hand."""

import numpy as np
import pytest

from studio.reference import gait


def swinging(phase, cadence):
    tempo = gait.tempo(cadence)
    return (phase - gait.leg_offsets(tempo)) % 1.0 < 1.0 - gait.duty(tempo)


@pytest.mark.parametrize("cadence", [0.3, 0.45, 0.7, 0.9])
def test_a_crawl_never_has_two_feet_in_the_air(cadence):
    assert gait.duty(gait.tempo(cadence)) >= 0.8
    count = [np.sum(swinging(phase, cadence)) for phase in np.linspace(0.0, 1.0, 500)]
    assert max(count) == 1


@pytest.mark.parametrize("cadence", [1.4, 1.8, 2.5])
def test_a_trot_swings_diagonal_feet_together(cadence):
    for phase in np.linspace(0.0, 1.0, 200):
        fr, fl, rr, rl = swinging(phase, cadence)
        assert fr == rl
        assert fl == rr


def test_the_front_left_foot_lifts_at_phase_zero_and_the_right_half_a_stride_later():
    for cadence in (0.3, 0.8, 1.2, 2.0):
        offsets = gait.leg_offsets(gait.tempo(cadence))
        assert offsets[1] == 0.0
        assert offsets[0] == 0.5


@pytest.mark.parametrize("cadence", np.linspace(0.0, 2.5, 26))
@pytest.mark.parametrize("half", [0.0, 0.5])
def test_every_foot_stands_at_the_rest_phase_whatever_the_cadence(cadence, half):
    assert not np.any(swinging(gait.REST_PHASE + half, cadence))


def test_speed_is_travel_times_cadence_over_duty():
    assert gait.speed_limit(1.4) == pytest.approx(0.26 * 1.4 / 0.6)  # 0.607
    assert gait.speed_limit(0.9) == pytest.approx(0.30 * 0.9 / 0.8)  # 0.3375
    assert gait.speed_limit(2.3) == gait.MAX_SPEED
    # Turning at 0.2 rad/s the outer feet, 0.1308 m out, go 0.02616 m/s faster.
    assert gait.speed_limit(1.4, 0.2) == pytest.approx(0.26 * 1.4 / 0.6 - 0.02616)


def test_a_march_means_more_speed_the_higher_and_the_quicker_it_is():
    assert gait.march_speed(1.4, 0.0) == 0.0
    # Half a lift is three quarters of the longest step: 1 - (1 - 0.5)^2.
    assert gait.march_speed(1.4, 0.5) == pytest.approx(0.75 * 0.26 * 1.4 / 0.6)
    speed = gait.march_speed(np.linspace(0.3, 2.3, 50), 0.6)
    assert np.all(np.diff(speed) >= 0.0)


def test_march_lift_undoes_march_speed():
    lift = np.linspace(0.0, 1.0, 21)
    np.testing.assert_allclose(gait.march_lift(1.1, gait.march_speed(1.1, lift)), lift, atol=1e-12)


def test_clearance_is_three_to_eight_centimetres_and_none_at_rest():
    assert gait.clearance(0.0, 0.5) == 0.0
    assert gait.clearance(1.0, 0.5) == pytest.approx(0.08)
    lifts = np.linspace(0.15, 1.0, 20)
    for cadence in (0.4, 1.0, 2.0):
        assert np.all(gait.clearance(lifts, cadence) >= 0.03)
        assert np.all(gait.clearance(lifts, cadence) <= 0.08 + 1e-12)


def test_a_swing_speeds_up_evens_out_and_slows_down():
    s = np.linspace(0.0, 1.0, 2001)
    way = gait.swing_profile(s)
    speed = np.gradient(way, s)
    assert way[0] == 0.0
    assert way[-1] == 1.0
    assert np.max(speed) == pytest.approx(4.0 / 3.0, rel=1e-3)
    assert np.all(np.diff(way) >= 0.0)
    assert speed[0] < 0.01
    assert gait.swing_height(0.0) == gait.swing_height(1.0) == 0.0
    assert gait.swing_height(0.5) == 1.0


def test_sway_follows_the_pendulum_and_vanishes_in_a_trot():
    assert gait.sway(0.3, 1.5, 1.0) == pytest.approx([gait.FORWARD, 0.0])
    # While the rear right foot swings (0.35 to 0.48) the body is left, half a stride on right.
    slow = gait.sway(np.array([0.42, 0.92]), np.full(2, 0.3), np.zeros(2))
    assert slow[0, 1] > 0.02
    assert slow[1, 1] == pytest.approx(-slow[0, 1])
    phase = np.linspace(0.0, 1.0, 101)
    quick, calm = (np.ptp(gait.sway(phase, np.full(101, f), np.zeros(101))[:, 1]) for f in (1, 0.3))
    assert quick < 0.8 * calm


def test_the_zero_moment_point_of_the_sway_is_the_wave_it_was_made_from():
    # x - (h/g) x'' of A cos(w t) / (1 + w^2 h/g) is A cos(w t): no filter is left.
    cadence, dt = 0.5, 1e-3
    t = np.arange(0.0, 2.0, dt)
    y = gait.sway(cadence * t, np.full(len(t), cadence), np.zeros(len(t)))[:, 1]
    zmp = y[1:-1] - 0.26 / 9.81 * (y[2:] - 2 * y[1:-1] + y[:-2]) / dt**2
    turn = 2 * np.pi * (cadence * t[1:-1] - 0.48)
    wave = gait.SWAY_Y * (np.cos(turn) - 0.25 * np.cos(3 * turn))
    np.testing.assert_allclose(zmp, wave, atol=1e-4)
