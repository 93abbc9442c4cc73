"""One-euro against closed forms, and what happens to directions that go missing."""

import math

import numpy as np
import pytest

from studio.human.filters import HoldThenEase, OneEuro, smoothing

DT = 1.0 / 30.0


def test_smoothing_of_one_and_a_half_hertz_by_hand():
    # r = 2 pi * 1.5 / 30 = 0.314159; r / (1 + r) = 0.239057
    assert smoothing(1.5, DT) == pytest.approx(0.239057, abs=1e-6)


def test_one_euro_without_beta_is_the_first_order_low_pass():
    filter_ = OneEuro(1.5, 0.0)
    filter_.push(np.zeros((1, 3)))
    gain = float(smoothing(1.5, DT))
    for n in range(1, 20):
        value = filter_.push(np.ones((1, 3)))
        assert value == pytest.approx(np.full((1, 3), 1.0 - (1.0 - gain) ** n))


def test_one_euro_first_step_by_hand():
    filter_ = OneEuro(1.5, 0.5)
    filter_.push(np.zeros((1, 3)))
    # 0.1 m in 1/30 s is 3 m/s; the 1 Hz low-pass of the speed has r = .20944, gain .173172:
    # 0.519516 m/s; cutoff 1.5 + .5 * .519516 = 1.759758 Hz; r = .368563, gain .269307
    value = filter_.push(np.array([[0.1, 0.0, 0.0]]))
    assert value[0, 0] == pytest.approx(0.0269307, abs=1e-7)
    assert value[0, 1:] == pytest.approx([0.0, 0.0])


def test_one_euro_turns_with_the_world():
    rng = np.random.default_rng(3)
    x = rng.normal(size=(60, 4, 3)).cumsum(axis=0) * 0.05
    c, s = math.cos(0.7), math.sin(0.7)
    turn = np.array([[c, -s, 0], [s, c, 0], [0, 0, 1.0]])
    straight, turned = OneEuro(), OneEuro()
    for row in x:
        assert turned.push(row @ turn.T) == pytest.approx(straight.push(row) @ turn.T)


def test_one_euro_smooths_jitter_and_follows_a_quick_hand():
    rng = np.random.default_rng(0)
    still = OneEuro()
    noise = rng.normal(scale=0.02, size=(300, 1, 3))
    out = np.array([still.push(row) for row in noise])[30:]
    assert out.std() < 0.5 * noise.std()
    slow, quick = OneEuro(1.5, 0.0), OneEuro(1.5, 0.5)
    ramp = np.linspace(0.0, 2.0, 31)[:, None, None] * np.ones((1, 3))  # 2 m/s
    lag_slow = ramp[-1] - [slow.push(row) for row in ramp][-1]
    lag_quick = ramp[-1] - [quick.push(row) for row in ramp][-1]
    assert lag_quick.max() < 0.75 * lag_slow.max()


def test_what_goes_missing_is_held_and_then_eased_to_neutral_as_a_unit_vector():
    neutral = np.array([[0.0, 0.0, -1.0], [1.0, 0.0, 0.0]])
    hold = HoldThenEase(neutral, hold=0.5, tau=0.5)
    raised = np.array([[0.0, 0.6, 0.8], [0.0, 1.0, 0.0]])
    hold.push(raised, np.array([True, True]))
    unseen_first = np.array([[np.nan] * 3, raised[1]])
    seen = np.array([False, True])
    out = [hold.push(unseen_first, seen) for _ in range(90)]
    for value in out[:15]:
        assert value[0] == pytest.approx(raised[0])
    assert np.linalg.norm(np.array(out)[:, 0], axis=-1) == pytest.approx(np.ones(90))
    assert out[-1][0] == pytest.approx(neutral[0], abs=0.05)
    assert out[-1][1] == pytest.approx(raised[1])
    assert hold.age == pytest.approx([3.0, 0.0])


def test_what_was_never_seen_is_neutral_at_once():
    neutral = np.array([[0.0, 0.0, -1.0]])
    assert HoldThenEase(neutral).push(np.ones((1, 3)), np.array([False])) == pytest.approx(neutral)


def test_easing_from_straight_opposite_neutral_does_not_divide_by_zero():
    neutral = np.array([[0.0, 0.0, -1.0]])
    hold = HoldThenEase(neutral, hold=0.0, tau=DT / math.log(2.0))  # the gain is exactly 1/2
    hold.push(-neutral, np.array([True]))
    assert hold.push(-neutral, np.array([False])) == pytest.approx(neutral)
