"""The ways from 0 to 1: their ends, and one number as in an array."""

import numpy as np
import pytest

from studio.geometry.time_scaling import minimum_jerk, smoothstep

S = np.linspace(-0.5, 1.5, 41)


@pytest.mark.parametrize(
    ("way", "at_a_quarter"), [(smoothstep, 0.15625), (minimum_jerk, 0.103515625)]
)
def test_a_way_rises_from_0_to_1_symmetrically_and_one_number_is_as_in_an_array(way, at_a_quarter):
    whole = way(S)
    assert whole.tolist() == [way(s) for s in S.tolist()]
    assert isinstance(way(0.3), float)
    assert way(0.25) == at_a_quarter
    assert (whole[S <= 0.0] == 0.0).all()
    assert (whole[S >= 1.0] == 1.0).all()
    assert (np.diff(whole) >= 0.0).all()
    np.testing.assert_allclose(whole + way(1.0 - S), 1.0, atol=1e-15)


def test_minimum_jerk_does_not_accelerate_at_its_ends_where_smoothstep_does():
    h = 1e-3
    assert minimum_jerk(h) < 1.1 * 10.0 * h**3
    assert smoothstep(h) > 2.0 * h**2
