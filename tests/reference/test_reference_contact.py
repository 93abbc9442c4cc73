"""Contact labels against the corners the paper fixes and a value worked out by hand."""

import numpy as np
import pytest

from studio.geometry.time_scaling import smoothstep
from studio.reference.contact import contact_label, contact_labels


def test_corners_of_the_paper():
    assert contact_label(0.0, 0.0) == 1.0
    assert contact_label(0.021, 0.0) == 0.0
    assert contact_label(0.0, 0.61) == 0.0
    assert contact_label(-0.001, 0.0) == 1.0


def test_between_the_corners_both_parts_multiply():
    # smoothstep(1/2) = 3/4 - 2/8 = 1/2; smoothstep(3/4) = 27/16 - 54/64 = 27/32.
    assert contact_label(0.01, 0.15) == pytest.approx(0.5 * 27.0 / 32.0)
    assert smoothstep(0.75) == pytest.approx(27.0 / 32.0)


def test_a_foot_on_the_floor_at_thirty_centimetres_a_second_is_half_a_contact():
    feet = np.zeros((5, 4, 3))
    feet[..., 2] = 0.02
    feet[:, 1, 0] = 0.01 * np.arange(5)  # 1 cm a frame at 30 Hz
    labels = contact_labels(feet, 1.0 / 30.0)
    np.testing.assert_allclose(labels[:, 1], 0.5)
    np.testing.assert_allclose(labels[:, [0, 2, 3]], 1.0)
