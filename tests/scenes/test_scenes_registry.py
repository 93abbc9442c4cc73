"""Every scene is built, begins, and can be finished in principle; its words are for people."""

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.scene_plays import PLAYS
from studio.link.link import Order
from studio.options import SCENES
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.scenes.registry import scene
from studio.scenes.scene import Scene
from studio.scenes.stage import Stage

PLAYED = [name for name in SCENES if scene(name).steps]


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_is_built_and_begins_with_nothing_done(name: str) -> None:
    stage = Stage(name, seed=3)
    state = stage.reset(NEUTRAL["stand"])
    assert np.allclose(state.base_pos[:2], stage.scene.start[:2])
    for _ in range(60):
        state = stage.step(Order(target=a1.STAND_JOINT_POS))
    assert state.foot_contact.all()
    assert not state.trunk_contact
    progress = stage.progress()
    assert (progress["name"], progress["step"], progress["score"]) == (name, 0, 0)
    assert not progress["finished"]
    assert progress["failed"] is None
    assert progress["time_s"] == 0.0  # the clock waits for the robot to move


@pytest.mark.parametrize("name", SCENES)
def test_a_scene_says_what_to_do(name: str) -> None:
    found = scene(name)
    assert found.title
    assert found.about.endswith(".")
    names = [step.name for step in found.steps]
    assert len(set(names)) == len(names)
    assert all(step.goal.endswith(".") and step.within > step.hold for step in found.steps)
    props = {prop.name for prop in found.props}
    assert len(props) == len(found.props)
    assert {*found.avoid, *found.scatter} <= props
    assert all(step.throw is None or step.throw.ball in props for step in found.steps)


@pytest.mark.parametrize("name", PLAYED)
def test_the_scripted_operator_knows_how_to_do_each_step(name: str) -> None:
    assert set(PLAYS[name]) == {step.name for step in scene(name).steps}


def test_an_unknown_scene_is_answered_with_the_known_ones() -> None:
    with pytest.raises(StudioError, match="greeting"):
        Stage("moon")


def test_empty_is_what_free_was_called() -> None:
    assert scene("empty") is scene("free")
    assert not isinstance(scene("free").props, list)
    assert scene("free") == Scene(
        name="free", title="Free roam", about="A bare floor. Go where you like."
    )
