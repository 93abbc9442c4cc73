"""The heading, held by the gyro: against hand-computed steps."""

import numpy as np
import pytest

from studio.control.observation import (
    GYRO_YAW,
    HEADING_CLIP,
    YAW_RATE,
    History,
    ObservationConfig,
)
from studio.errors import StudioError
from studio.robot import a1

DT = a1.CONTROL_DT


def frames(yaw_rate: float = 0.0) -> tuple[np.ndarray, np.ndarray]:
    """A standing robot's z, and a reference that asks for a yaw rate."""
    z, p = np.zeros((1, 17)), np.zeros((1, 18))
    z[:, :12] = p[:, :12] = a1.STAND_JOINT_POS
    p[0, YAW_RATE] = yaw_rate
    return z, p


def test_a_heading_that_is_missed_is_added_to_the_yaw_rate() -> None:
    history = History(1, ObservationConfig(heading_gain=2.0, hold_tau=5.0))
    z, p = frames(yaw_rate=0.3)
    z[0, GYRO_YAW] = 0.1
    history.reset(slice(None), z, p)
    history.push(z, p)
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
        history.reset(slice(None), z, p)
        for rate in gyro:
            z[0, GYRO_YAW] = rate
            history.push(z, p)
            shown.append(history.reference[0, -1, YAW_RATE])
        return np.array(shown)

    stride = np.cos(2.0 * np.pi * 2.0 * DT * np.arange(120))  # 2 Hz, 1 rad/s
    swing = [np.ptp(steering(smooth, stride)[60:]) for smooth in (0.0, 1.0)]
    # A first-order mean over 1 s passes 1 / |1 + 2 pi 2 i| = 1 / 12.6 of it.
    assert swing[1] / swing[0] == pytest.approx(1.0 / 12.6, rel=0.15)
    turned_away = np.zeros(150)
    turned_away[:30] = 0.2  # 0.2 rad off after a second, then straight on
    assert steering(1.0, turned_away)[-1] == pytest.approx(-0.2, rel=0.05)


def test_errors_are_bounded_and_forgotten_by_a_reset() -> None:
    history = History(1, ObservationConfig(heading_gain=1.0))
    z, p = frames(yaw_rate=1.0)
    history.reset(slice(None), z, p)
    for _ in range(60):
        history.push(z, p)
    assert history.heading_error[0] == pytest.approx(HEADING_CLIP)
    history.reset(slice(None), z, p)
    assert not history.heading_error.any()
    assert not history.steering.any()


def test_nothing_is_held_by_default() -> None:
    history = History(1, ObservationConfig())
    z, p = frames(yaw_rate=1.0)
    history.reset(slice(None), z, p)
    history.push(z, p)
    np.testing.assert_array_equal(history.reference[0], np.tile(p, (4, 1)))


def test_holding_without_a_gyro_is_refused() -> None:
    with pytest.raises(StudioError, match="yaw rate"):
        ObservationConfig(yaw_rate=False, heading_gain=1.0)
