"""The action filter against SciPy's and its limits."""

import numpy as np
import pytest
from scipy import signal

from studio.robot import a1
from studio.sim.actuation import LowPass, limit_target


def test_low_pass_is_scipy_s_second_order_butterworth():
    x = np.random.default_rng(0).normal(size=(200, 12))
    low_pass = LowPass()
    low_pass.reset(x[0])
    ours = np.array([low_pass.step(v) for v in x])
    sos = signal.butter(2, 5.0, fs=30.0, output="sos")
    rest = signal.sosfilt_zi(sos)[..., None] * x[0]
    expected, _ = signal.sosfilt(sos, x, axis=0, zi=rest)
    np.testing.assert_allclose(ours, expected, atol=1e-12)


def test_at_rest_a_constant_passes_unchanged_from_the_first_step():
    low_pass = LowPass()
    low_pass.reset(a1.STAND_JOINT_POS)
    for _ in range(3):
        np.testing.assert_allclose(low_pass.step(a1.STAND_JOINT_POS), a1.STAND_JOINT_POS)


def test_five_hertz_comes_out_at_half_power():
    t = np.arange(3000) / 30.0
    low_pass = LowPass()
    low_pass.reset(np.zeros(1))
    y = np.array([low_pass.step(v)[0] for v in np.sin(2 * np.pi * 5.0 * t)[:, None]])
    assert np.std(y[300:]) / np.std(np.sin(2 * np.pi * 5.0 * t)) == pytest.approx(
        1 / np.sqrt(2), rel=1e-3
    )


def test_a_slow_motion_is_delayed_by_41_ms():
    t = np.arange(600) / 30.0
    low_pass = LowPass()
    low_pass.reset(np.zeros(1))
    y = np.array([low_pass.step(v)[0] for v in t[:, None]])  # a ramp lags by the group delay
    # analogue: sqrt(2) / (2 pi 5 Hz) = 45 ms; bilinear, prewarped: sqrt(2) / (60 tan 30 deg)
    assert t[-1] - y[-1] == pytest.approx(0.04082, abs=1e-4)


def test_rows_of_a_batch_reset_on_their_own():
    low_pass = LowPass()
    low_pass.reset(np.zeros((2, 12)))
    low_pass.step(np.ones((2, 12)))
    low_pass.reset(np.full((2, 12), 0.5), where=[True, False])
    out = low_pass.step(np.full((2, 12), 0.5))
    np.testing.assert_allclose(out[0], 0.5)
    assert np.all(np.abs(out[1] - 0.5) > 0.01)


def test_limits_hold_after_the_filter_though_it_overshoots():
    low_pass = LowPass()
    low_pass.reset(np.zeros(12))
    filtered = np.array([low_pass.step(a1.JOINT_UPPER) for _ in range(30)])
    assert np.any(filtered > a1.JOINT_UPPER + 1e-3)
    limited = limit_target(filtered)
    assert np.all(limited <= a1.JOINT_UPPER)
    assert np.all(limited >= a1.JOINT_LOWER)


def test_targets_move_no_faster_than_the_joints_can():
    previous = a1.STAND_JOINT_POS
    out = limit_target(previous + 5.0, previous)
    # 21 rad/s / 30 Hz = 0.7 rad, and the joint limits
    np.testing.assert_allclose(out, np.minimum(previous + 0.7, a1.JOINT_UPPER))
