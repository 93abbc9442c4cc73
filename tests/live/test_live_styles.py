"""Changing what walking means while the robot is driven: experts, operator and state follow."""

import numpy as np
import pytest
from fake_clock import FakeClock
from pydantic import ValidationError
from turning import ask, run

from studio.human.skeleton import INDEX
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig


@pytest.fixture
def loop(tmp_path):
    config = RuntimeConfig(source="operator:walk", sessions=tmp_path / "sessions")
    made = LiveLoop(clock=FakeClock(), runtime=Runtime(config))
    yield made
    made.runtime.close()


def test_a_style_is_changed_without_restart_and_the_operator_walks_in_it_without_a_jump(loop):
    run(loop, 1.0)
    source = loop.runtime.source
    assert ask(loop, c.SetStyle(style="circles")).ok
    ticks = run(loop, 3.0)
    state = loop.state_dict()
    assert (state["style"], state["mapper"]["style"]) == ("circles", "circles")
    assert loop.runtime.source is source
    assert np.mean([tick.expert == "walk" for tick in ticks[60:]]) > 0.9
    # The feet stay on the floor now, and nothing leapt on the way there.
    people = [tick.human for tick in ticks if tick.human is not None]
    assert len(people) == len(ticks)
    joints = np.array([person.joint_pos_w for person in people])
    ankles = joints[60:, [INDEX["l_ankle"], INDEX["r_ankle"]], 2]
    assert np.ptp(ankles, axis=0).max() < 0.1
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() < 0.25
    assert loop.state_dict()["counters"]["rejected"] == 0


def test_going_back_brings_the_style_back_too(loop):
    assert ask(loop, c.SetStyle(style="semantic")).ok
    assert ask(loop, c.MapperBack()).ok
    assert loop.state_dict()["style"] == "march"
    assert loop.runtime.source.person.style == "march"


def test_in_collect_the_person_who_acts_takes_up_the_style_and_so_does_who_waits(loop):
    assert ask(loop, c.SetMode(mode="collect")).ok
    assert ask(loop, c.SetStyle(style="circles")).ok
    assert loop.runtime.source.person.style == "circles"
    assert ask(loop, c.SetMode(mode="live")).ok
    assert loop.runtime.source.person.style == "circles"
    assert loop.runtime.about()["style"] == "circles"
    assert ask(loop, c.SetSource(source="operator:march")).ok
    assert loop.runtime.source.person.style == "circles"


def test_a_style_is_not_changed_in_the_midst_of_a_take_and_an_unknown_one_never(loop):
    assert ask(loop, c.StartTake()).ok
    answer = ask(loop, c.SetStyle(style="circles"))
    assert not answer.ok
    assert "stop it first" in answer.why
    assert ask(loop, c.StopTake()).ok
    with pytest.raises(ValidationError, match="circles"):
        c.SetStyle(style="waltz")
    assert loop.state_dict()["style"] == "march"
