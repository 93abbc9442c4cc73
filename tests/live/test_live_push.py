"""A hand that pushes the robot: a force for a moment, in physics, that a stop lets go of."""

import numpy as np
import pytest
from fake_clock import FakeClock
from pydantic import ValidationError
from turning import ask, run

from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.sim.pull import MAX_FORCE, Pull


@pytest.fixture
def loop(tmp_path):
    """A loop on a fake clock, whose robot stands."""
    config = RuntimeConfig(source="operator:quiet", sessions=tmp_path)
    loop = LiveLoop(config, clock=FakeClock())
    run(loop, 1.5)
    return loop


def base(loop) -> np.ndarray:
    return np.array(loop.state_dict()["robot"]["base_pos"])


def test_a_push_moves_the_robot_that_way_and_ends_by_itself(loop):
    at = base(loop)
    answer = ask(loop, c.Push(force=(0.0, 40.0, 0.0), seconds=0.4))
    assert answer.ok
    assert answer.state["push"] == [0.0, 40.0, 0.0]
    run(loop, 0.3)
    pushed = base(loop) - at
    assert pushed[1] > 0.01
    assert abs(pushed[1]) > 2 * abs(pushed[0])
    run(loop, 0.3)
    assert loop.state_dict()["push"] == [0.0, 0.0, 0.0]
    world = loop.runtime.puppeteer.stage.world
    assert not world.data.xfrc_applied.any()


def test_a_stop_lets_go_and_whoever_is_stopped_cannot_be_pushed(loop):
    assert ask(loop, c.Push(force=(30.0, 0.0, 0.0), seconds=1.0)).ok
    run(loop, 0.1)
    assert ask(loop, c.Stop()).ok
    assert loop.state_dict()["push"] == [0.0, 0.0, 0.0]
    assert not loop.runtime.puppeteer.stage.world.data.xfrc_applied.any()
    refused = ask(loop, c.Push(force=(30.0, 0.0, 0.0)))
    assert not refused.ok
    assert "push" in refused.why
    ask(loop, c.Reset())
    ask(loop, c.Arm())
    run(loop, 1.5)
    assert ask(loop, c.Push(force=(5.0, 0.0, 0.0))).ok


def test_it_is_refused_beyond_its_limits_and_while_motions_are_shown(loop):
    for bad in ((61.0, 0.0, 0.0), (50.0, 50.0, 0.0), (float("nan"), 0.0, 0.0), (1.0, 2.0)):
        with pytest.raises(ValidationError):
            c.Push(force=bad)  # type: ignore[arg-type]
    with pytest.raises(ValidationError):
        c.Push(force=(1.0, 0.0, 0.0), seconds=2.0)
    assert ask(loop, c.SetMode(mode="collect")).ok
    refused = ask(loop, c.Push(force=(5.0, 0.0, 0.0)))
    assert not refused.ok
    assert "collect" in refused.why


@pytest.mark.parametrize("angle", np.linspace(0.0, 6.0, 25).tolist())
def test_the_most_may_be_pushed_in_any_direction(angle):
    push = c.Push(force=(MAX_FORCE * np.cos(angle), MAX_FORCE * np.sin(angle), 0.0))
    Pull().ask(push.force, push.seconds)


def test_a_run_that_was_helped_along_is_nobodys_best(loop):
    ask(loop, c.SetScene(scene="push"))
    stage = loop.runtime.puppeteer.stage
    assert not stage.pushed
    ask(loop, c.Push(force=(5.0, 0.0, 0.0)))
    assert stage.pushed
    ask(loop, c.SetScene(scene="push"))
    assert not loop.runtime.puppeteer.stage.pushed


def test_without_a_push_the_world_is_untouched(loop):
    world = loop.runtime.puppeteer.stage.world
    world.data.xfrc_applied[1, 0] = 3.0  # another's
    Pull().step(world)
    assert world.data.xfrc_applied[1, 0] == 3.0
    pull = Pull()
    pull.ask((MAX_FORCE, 0.0, 0.0), 0.1)
    pull.step(world)
    trunk = world.model.body("trunk").id
    assert world.data.xfrc_applied[trunk, 0] == MAX_FORCE
