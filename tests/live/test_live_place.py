"""The robot is set down elsewhere: only where nobody drives it, within limits, and a stop stays."""

import threading

import numpy as np
import pytest
from fake_clock import FakeClock
from pydantic import ValidationError
from turning import ask, run

from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig


@pytest.fixture
def loop(tmp_path):
    """A loop on a fake clock, whose robot stands."""
    config = RuntimeConfig(source="operator:quiet", sessions=tmp_path)
    loop = LiveLoop(config, clock=FakeClock())
    run(loop, 1.5)
    yield loop
    loop.runtime.close()


def stands_at(loop, x: float, y: float, yaw: float) -> None:
    """Upright there, within what standing up from a crouch shifts."""
    run(loop, 2.5)
    robot = loop.runtime.puppeteer.robot
    np.testing.assert_allclose(robot.base_pos[:2], [x, y], atol=0.05)
    assert robot.base_pos[2] > 0.25
    assert abs(np.angle(np.exp(1j * (robot.yaw - yaw)))) < 0.1


def test_a_stopped_robot_stands_up_where_it_is_put_and_stays_stopped_until_armed(loop):
    ask(loop, c.Stop())
    run(loop, 0.5)
    answer = ask(loop, c.PlaceRobot(x=2.0, y=-1.5, yaw=1.2))
    assert answer.ok, answer.why
    stands_at(loop, 2.0, -1.5, 1.2)
    state = loop.state_dict()
    assert state["stopped"]
    assert not state["needs_reset"]
    assert not state["armed"]
    assert ask(loop, c.Arm()).ok
    stands_at(loop, 2.0, -1.5, 1.2)


def test_an_idle_robot_is_put_elsewhere_heading_as_it_did_and_follows_from_there(loop):
    ask(loop, c.SetMode(mode="idle"))
    run(loop, 0.5)
    assert ask(loop, c.PlaceRobot(x=-3.0, y=0.5, yaw=2.0)).ok
    stands_at(loop, -3.0, 0.5, 2.0)
    assert ask(loop, c.PlaceRobot(x=1.0, y=1.0)).ok
    stands_at(loop, 1.0, 1.0, 2.0)
    assert not loop.state_dict()["stopped"]
    assert ask(loop, c.SetMode(mode="live")).ok
    stands_at(loop, 1.0, 1.0, 2.0)
    assert not loop.state_dict()["fallen"]


def refusal(loop) -> str:
    answer = ask(loop, c.PlaceRobot(x=1.0, y=0.0))
    assert not answer.ok
    return answer.why


def test_it_is_refused_while_the_robot_follows_shows_or_is_recorded_and_among_props(loop):
    assert "stop the robot" in refusal(loop)
    ask(loop, c.StartTake())
    ask(loop, c.Stop())
    assert "is being recorded" in refusal(loop)
    ask(loop, c.StopTake())
    ask(loop, c.SetMode(mode="replay"))
    assert "idle" in refusal(loop)
    ask(loop, c.SetMode(mode="idle"))
    ask(loop, c.Reset())
    ask(loop, c.SetScene(scene="slalom"))
    assert "start of its own" in refusal(loop)
    np.testing.assert_allclose(loop.runtime.puppeteer.robot.base_pos[:2], 0.0, atol=0.1)


def test_a_place_sent_before_the_last_stop_moves_nobody(loop):
    ask(loop, c.Stop())
    seen = loop.stops
    ask(loop, c.Stop())
    answers = []
    late = threading.Thread(
        target=lambda: answers.append(loop.submit(c.PlaceRobot(x=1.0, y=0.0), 60.0, seen))
    )
    late.start()
    while late.is_alive():
        late.join(0.01)
        run(loop, 1 / 30)
    assert not answers[0].ok
    assert loop.state_dict()["needs_reset"]


@pytest.mark.parametrize(
    "bad",
    [
        {"x": 51.0, "y": 0.0},
        {"x": 40.0, "y": -40.0},
        {"x": float("nan"), "y": 0.0},
        {"x": float("inf"), "y": 0.0},
        {"x": 0.0},
        {"x": "1", "y": 0.0},
        {"x": 0.0, "y": 0.0, "yaw": 4.0},
        {"x": 0.0, "y": 0.0, "z": 1.0},
    ],
)
def test_places_beyond_its_limits_are_refused(bad):
    with pytest.raises(ValidationError):
        c.PlaceRobot(**bad)
