"""Deadlines are absolute: one late period shifts nothing, a long pause is not caught up."""

import time

import pytest
from fake_clock import FakeClock

from studio.live.clock import Metronome, WallClock


def test_deadlines_do_not_drift_when_a_period_is_late():
    clock = FakeClock(10.0)
    metronome = Metronome(clock, dt=0.1)
    clock.advance(0.04)
    metronome.wait()
    assert clock.now() == pytest.approx(10.1)
    clock.advance(0.13)  # 0.03 s late
    assert metronome.wait() == pytest.approx(0.03)
    assert metronome.late == 1
    clock.advance(0.02)
    metronome.wait()
    assert clock.now() == pytest.approx(10.3)  # 10.0 + 3 periods, as if nothing had been late


def test_after_a_long_pause_the_missed_periods_are_dropped():
    clock = FakeClock()
    metronome = Metronome(clock, dt=0.1, slack=3.0)
    clock.advance(5.0)
    metronome.wait()
    before = clock.now()
    clock.advance(0.01)
    metronome.wait()
    assert clock.now() - before == pytest.approx(0.1)


def test_the_wall_clock_never_wakes_early():
    clock = WallClock()
    errors = []
    for _ in range(20):
        goal = clock.now() + 0.005
        clock.sleep_until(goal)
        errors.append(time.perf_counter() - goal)
    assert all(error >= 0.0 for error in errors)
