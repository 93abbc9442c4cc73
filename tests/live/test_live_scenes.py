"""Scenes in the live loop: chosen, played, begun anew by a reset, refused where they would hurt."""

import numpy as np
import pytest
from fake_clock import FakeClock
from turning import ask, run

from studio.control.drive_command import PuppeteerConfig
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.reference.intent import Intent
from studio.synthetic.operator import InteractiveOperator


@pytest.fixture
def make(tmp_path):
    """A loop on a fake clock that follows the operator at a task, in a scene."""

    def build(task: str = "quiet", scene: str = "empty") -> LiveLoop:
        config = RuntimeConfig(
            source=f"operator:{task}", sessions=tmp_path, puppeteer=PuppeteerConfig(scene=scene)
        )
        return LiveLoop(config, clock=FakeClock())

    return build


def greet(loop: LiveLoop) -> None:
    """The person leans to the right for two seconds."""
    person = loop.runtime.source
    assert isinstance(person, InteractiveOperator)
    run(loop, 0.5)
    person.set_intent(Intent(tilt=np.array([0.4, 0.0, 0.0])))
    run(loop, 2.0)


def test_a_scene_is_chosen_and_its_progress_is_in_the_state(make):
    loop = make("interactive")
    run(loop, 0.5)
    assert loop.state_dict()["progress"]["steps"] == []
    answer = ask(loop, c.SetScene(scene="greeting"))
    assert answer.ok
    assert answer.state["scene"] == "greeting"
    assert answer.state["progress"]["step"] == 0
    assert "lean" in answer.state["progress"]["steps"][0]["text"]
    greet(loop)
    progress = loop.state_dict()["progress"]
    assert progress["steps"][0]["done"]
    assert progress["score"] > 0
    assert 0.0 < progress["steps"][0]["t"] <= progress["time_s"]
    back = ask(loop, c.SetScene(scene="free"))
    assert (back.state["scene"], back.state["progress"]["steps"]) == ("free", [])


def test_a_stop_and_a_reset_begin_the_scene_anew(make):
    loop = make("interactive", "greeting")
    greet(loop)
    assert loop.state_dict()["progress"]["step"] >= 1
    assert ask(loop, c.Stop()).ok
    run(loop, 1.0)
    refused = ask(loop, c.SetScene(scene="push"))
    assert not refused.ok
    assert "reset" in refused.why
    state = ask(loop, c.Reset()).state
    assert (state["progress"]["step"], state["progress"]["time_s"]) == (0, 0.0)
    assert np.allclose(state["robot"]["base_pos"][:2], 0.0, atol=0.05)


def test_a_scene_is_no_place_to_collect_in(make):
    loop = make()
    run(loop, 0.2)
    assert ask(loop, c.SetMode(mode="collect")).ok
    refused = ask(loop, c.SetScene(scene="push"))
    assert not refused.ok
    assert "live" in refused.why


def test_arming_among_props_leaves_the_robot_where_it_is(make):
    loop = make("walk", "push")
    run(loop, 4.0)
    ask(loop, c.Disarm())
    run(loop, 2.0)
    before = np.array(loop.state_dict()["robot"]["base_pos"][:2])
    reference = loop.runtime.puppeteer.state_machine.reference.base_pos[:2]
    assert np.linalg.norm(reference - before) > 0.0
    after = np.array(ask(loop, c.Arm()).state["robot"]["base_pos"][:2])
    assert np.allclose(after, before, atol=0.02)


def test_props_are_beside_the_robot_at_any_moment_for_whoever_looks(make, monkeypatch):
    loop = make(scene="push")
    run(loop, 0.2)
    runtime = loop.runtime
    seen = []
    step = runtime.puppeteer.step
    monkeypatch.setattr(
        runtime.puppeteer, "step", lambda *a: (seen.append(runtime.props), step(*a))[1]
    )
    run(loop, 0.2)  # another thread may look amid a period
    assert seen
    assert all(props is not None for props in seen)
    assert list(loop.state_dict()["props"]) == ["box"]
