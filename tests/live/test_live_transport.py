"""Playing, pausing, seeking and looping within a take, whatever shows it."""

import pytest

from studio.errors import StudioError
from studio.live.replay import Transport
from studio.robot.a1 import CONTROL_DT


def shown(transport, periods):
    """Row numbers of the control periods to come."""
    return [round(transport.advance() / CONTROL_DT) for _ in range(periods)]


def test_it_shows_each_period_once_and_pauses_on_the_last():
    transport = Transport("take", 4 * CONTROL_DT, playing=True)
    assert shown(transport, 4) == [0, 1, 2, 3]
    assert transport.playing
    assert shown(transport, 3) == [4, 4, 4]
    assert not transport.playing


def test_a_loop_shows_its_last_period_and_its_first_again():
    transport = Transport("take", 9 * CONTROL_DT, (2 * CONTROL_DT, 4 * CONTROL_DT))
    transport.seek(playing=True, loop=True)
    assert shown(transport, 7) == [2, 3, 4, 2, 3, 4, 2]


def test_what_was_sought_beyond_the_trim_plays_to_the_end_of_the_take():
    transport = Transport("take", 9 * CONTROL_DT, (2 * CONTROL_DT, 4 * CONTROL_DT), playing=True)
    transport.seek(t=7 * CONTROL_DT)
    assert shown(transport, 4) == [7, 8, 9, 9]
    assert not transport.playing


def test_playing_again_from_the_end_begins_anew():
    transport = Transport("take", 3 * CONTROL_DT, playing=True)
    shown(transport, 5)
    transport.seek(playing=True)
    assert shown(transport, 2) == [0, 1]


def test_it_stays_where_it_is_while_paused():
    transport = Transport("take", 1.0)
    transport.seek(t=0.5)
    assert {transport.advance() for _ in range(5)} == {0.5}


@pytest.mark.parametrize("speed", [0.0, -1.0, 4.1, float("nan")])
def test_an_impossible_speed_is_refused_and_changes_nothing(speed):
    transport = Transport("take", 1.0)
    with pytest.raises(StudioError, match=r"between 0\.1 and 4"):
        transport.seek(t=0.5, playing=True, speed=speed, loop=True)
    assert (transport.t, transport.playing, transport.speed, transport.loop) == (0, False, 1, False)
