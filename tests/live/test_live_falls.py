"""A robot that falls: the page's demo stands up by itself, every other stays down until a reset."""

import numpy as np
import pytest
from fake_clock import FakeClock

from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig

DT = 1.0 / 30.0


@pytest.fixture
def make(tmp_path):
    def build(spec) -> LiveLoop:
        config = RuntimeConfig(source=spec, sessions=tmp_path / "sessions")
        return LiveLoop(clock=FakeClock(), runtime=Runtime(config))

    return build


def run(loop, seconds, until=None):
    """States over `seconds`, or until one for which `until` holds."""
    states = []
    for _ in range(round(seconds / DT)):
        loop.tick()
        states.append(loop.state_dict())
        loop.wait()
        if until is not None and until(states[-1]):
            return states
    assert until is None, "it never came"
    return states


def knock_over(loop):
    """Throw the trunk aside until it lies."""
    run(loop, 1.0)
    for _ in range(40):
        loop.runtime.puppeteer.stage.world.push(np.array([0.0, 6.0, 1.5]))
        if run(loop, 0.3)[-1]["stopped"]:
            return
    raise AssertionError("the robot cannot be knocked over")


def test_the_demo_says_that_it_fell_and_stands_up_by_itself_after_three_seconds(make):
    loop = make("operator")
    knock_over(loop)
    state = loop.state_dict()
    assert state["counters"]["falls"] == 1
    assert state["reason"] == "fallen"
    assert "stands up by itself" in state["why"]
    lying = run(loop, 4.0, until=lambda s: not s["stopped"])
    assert len(lying) * DT > 2.0
    after = run(loop, 4.0)
    assert not any(s["stopped"] for s in after)
    assert after[-1]["armed"]
    assert after[-1]["robot"]["base_pos"][2] > 0.2
    assert after[-1]["counters"]["falls"] == 1


@pytest.mark.parametrize("spec", ["operator:march", "operator:interactive"])
def test_every_other_robot_stays_down(make, spec):
    loop = make(spec)
    knock_over(loop)
    assert all(s["needs_reset"] for s in run(loop, 5.0))


def test_a_stop_pressed_while_the_demo_lies_keeps_it_down(make):
    loop = make("operator")
    knock_over(loop)
    assert loop.post(c.Stop(by="a test"))
    assert all(s["needs_reset"] for s in run(loop, 5.0))
    assert "a test" in loop.state_dict()["why"]


def test_another_person_who_comes_while_the_demo_lies_finds_it_stopped(make):
    loop = make("operator")
    knock_over(loop)
    loop.runtime.mode = "idle"
    run(loop, 0.1)
    loop.runtime.mode = "live"
    assert all(s["needs_reset"] for s in run(loop, 5.0))
