"""What repeats itself goes on as it went; what does not is left alone."""

import numpy as np
import pytest

from studio.rhythm import MEMORY, PeriodicExtrapolator

RNG = np.random.default_rng(3)
SHAPE = RNG.standard_normal((2, 5, 3)) * 0.1


def march(k, stride):
    """(5, 3) m: points of a march with `stride` periods, two harmonics."""
    phase = 2.0 * np.pi * k / stride
    return SHAPE[0] * np.sin(phase) + 0.4 * SHAPE[1] * np.cos(2.0 * phase)


@pytest.mark.parametrize("stride", [12, 20, 31.5, 45])
def test_a_march_goes_on_as_it_went(stride):
    memory = PeriodicExtrapolator()
    for k in range(90):
        memory.see(march(k, stride))
    assert memory.ago is not None
    off = [np.abs(memory.guess() - march(90 + k, stride)).max() for k in range(15)]
    # Strides of no whole number of periods are half a period off at most.
    assert max(off) < 0.15 * np.abs(SHAPE).max() * (1.0 if stride % 1 == 0 else 2.0)


def test_what_never_repeated_itself_is_not_guessed():
    memory = PeriodicExtrapolator()
    assert memory.guess() is None
    for k in range(MEMORY):
        memory.see(np.full((5, 3), 0.01 * k))
    assert memory.guess() is None


def test_a_still_body_has_no_rhythm_however_it_trembles():
    memory = PeriodicExtrapolator()
    for k in range(MEMORY):
        memory.see(0.002 * march(k, 20) / np.abs(SHAPE).max())
    assert memory.guess() is None


def test_a_guess_begins_where_the_motion_was_even_if_this_stride_is_another():
    memory = PeriodicExtrapolator()
    for k in range(60):
        memory.see(march(k, 20) + (0.01 if k > 50 else 0.0))
    step = np.abs(memory.guess() - march(59, 20) - 0.01).max()
    assert step < 1.3 * np.abs(march(60, 20) - march(59, 20)).max()


def test_forgetting_forgets():
    memory = PeriodicExtrapolator()
    for k in range(60):
        memory.see(march(k, 20))
    memory.forget()
    assert memory.guess() is None
