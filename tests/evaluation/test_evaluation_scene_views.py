"""What a scripted operator knows of a scene: from outside, by the robot's camera, by its state."""

import re
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
import pytest

from studio import geometry
from studio.evaluation import composite as co
from studio.evaluation.scene_operator import (
    BLUR_M,
    LOOKS_ROUND,
    ON_S,
    REACTION_S,
    TURN_S,
    Eyes,
    ScriptedOperator,
    Sight,
)
from studio.evaluation.scene_plays import PLAYS
from studio.evaluation.scene_views import MISSES_S, View, eyes_of
from studio.link.link import Order
from studio.reference.intent import Intent
from studio.reference.stances import NEUTRAL
from studio.robot import camera
from studio.robot.a1 import CONTROL_DT, STAND_JOINT_POS
from studio.scenes.stage import Stage
from studio.sim.prop_world import PropWorld

EYE_JS = Path(__file__).parents[2] / "web_assets" / "js" / "eye.js"
REST = Intent()
LATE = round(REACTION_S / CONTROL_DT)
STAND = Order(target=STAND_JOINT_POS)
WALK = Intent(state="walk", task="walk", cadence=0.75, lift=0.5)


def at_start(scene: str, view: View) -> tuple[Stage, Eyes]:
    stage = Stage(scene)
    stage.reset(NEUTRAL["stand"])
    return stage, eyes_of(view, stage, np.random.default_rng(0))


def moved(stage: Stage, x: float, y: float, yaw: float) -> None:
    """The robot stands elsewhere, and the stage has looked."""
    stage.world.move_base([x, y], yaw)
    stage.step(STAND)


def seen(eyes: Eyes, meant: Intent = REST, periods: int = LATE + 1) -> Sight:
    """What they know once so many periods have been shown."""
    for _ in range(periods):
        sight = eyes.see(meant)
    return sight


def off(stage: Stage, sight: Sight, name: str) -> float:
    """m between where a prop is taken to be from the robot, and where it is."""
    robot = stage.world.state
    assert stage.seen is not None
    truly = geometry.turn_xy(stage.seen.pos[name][:2] - robot.base_pos[:2], -robot.yaw)
    return float(np.linalg.norm(sight.of(name) - truly))


def world_of(stage: Stage) -> PropWorld:
    assert isinstance(stage.world, PropWorld)
    return stage.world


def test_from_outside_everything_is_seen_to_the_bit_as_before_there_were_other_views() -> None:
    """A tape of somebody who sees from outside is made of these numbers alone."""
    stage, eyes = at_start("push", "third_person")
    rng = np.random.default_rng(0)
    for k in range(12):
        moved(stage, 0.1 * k, 0.0, 3.0)  # with its back to the box
        robot, places = stage.world.state, stage.seen
        assert places is not None
        base = robot.base_pos + BLUR_M * rng.standard_normal(3)
        pos = {n: p + BLUR_M * rng.standard_normal(3) for n, p in places.pos.items()}
        eyes.see(WALK)
        shown = eyes._shown[-1]
        assert np.array_equal(shown.base, base)
        assert shown.yaw == robot.yaw
        assert {n: p.tolist() for n, p in shown.pos.items()} == {
            n: p.tolist() for n, p in pos.items()
        }
        assert shown.spot("mark").tolist() == [2.3, 0.0]  # told, not seen
    assert not eyes.doubt("box")


@pytest.mark.parametrize("view", ["camera", "camera_state"])
def test_the_camera_sees_what_is_before_the_robot_and_nothing_behind_it(view: View) -> None:
    stage, eyes = at_start("push", view)
    world_of(stage).put("box", [1.7, 0.1, 0.2])  # elsewhere than the plan says
    stage.step(STAND)
    assert off(stage, seen(eyes), "box") < 0.1
    world_of(stage).put("box", [-1.0, 0.0, 0.2])
    stage.step(STAND)
    sight = seen(eyes, periods=5)
    assert sight.of("box")[0] == pytest.approx(1.7, abs=0.1)  # where it was last seen


def test_what_is_hidden_by_a_box_is_not_seen() -> None:
    stage, _ = at_start("push", "camera")
    world = world_of(stage)
    eye = world.state.base_pos + camera.MOUNT
    mark = world.position("mark")
    assert world.hidden(eye, mark, "mark")  # the box stands before it
    assert not world.hidden(eye, world.position("box"), "box")
    world.put("box", [1.5, 1.0, 0.2])
    assert not world.hidden(eye, mark, "mark")
    assert world.hidden(eye, mark - [0.0, 0.0, 0.1], "box")  # the ground hides, too


def test_the_robot_itself_hides_nothing() -> None:
    stage, _ = at_start("push", "camera")
    world = world_of(stage)
    behind = world.state.base_pos - [0.5, 0.0, 0.0]  # the whole trunk is in the way
    assert not world.hidden(behind, world.position("box"), "box")


@pytest.mark.parametrize(
    ("point", "inside"),
    [
        ([2.0, 0.0, 0.0], True),
        ([-2.0, 0.0, 0.0], False),
        ([11.0, 0.0, 0.0], False),
        ([1.29, 0.89, 0.0], True),
        ([1.29, 0.92, 0.0], False),
        ([1.29, 0.0, 0.61], True),
        ([1.29, 0.0, 0.63], False),
    ],
)
def test_a_picture_has_edges_and_a_range(point: list[float], inside: bool) -> None:
    assert camera.in_picture(point) == inside


def test_the_page_draws_the_same_camera() -> None:
    text = EYE_JS.read_text()
    front, fov = re.search(r"FRONT = (\[.*?\])", text), re.search(r"FOV = (\d+)", text)
    assert front is not None
    assert fov is not None
    assert front[1] == f"[{', '.join(f'{x:g}' for x in camera.MOUNT)}]"
    assert float(fov[1]) == pytest.approx(np.degrees(camera.FOV))


def test_with_the_robots_state_what_went_out_of_sight_is_carried_on_exactly() -> None:
    cases: tuple[tuple[View, float, float], ...] = (
        ("camera_state", 0.0, 0.1),
        ("camera", 0.5, 9.0),
    )
    for view, least, most in cases:
        stage, eyes = at_start("push", view)
        assert off(stage, seen(eyes), "box") < 0.1
        moved(stage, 0.9, 0.9, -0.2 + np.pi)  # carried off and turned round: nobody asked for it
        assert least <= off(stage, seen(eyes), "box") <= most, view


def test_by_the_camera_alone_what_went_out_of_sight_moves_on_as_was_asked_for() -> None:
    _, eyes = at_start("push", "camera")  # which stays where it is
    walked = -seen(eyes).base[0] + seen(eyes, WALK, 150).base[0]
    assert walked == pytest.approx(0.3 * (5.0 - 2.1), abs=0.15)  # m: 5 s, of which 2.1 to start
    turning = seen(eyes, Intent(state="walk", task="walk", cadence=0.5, turn=0.4), 90)
    assert turning.turning > 0.1
    assert seen(eyes, Intent(state="sit"), 120).base[2] > 0.3
    assert seen(eyes, Intent(), 120).base[2] < 0.3


def test_what_is_not_where_it_should_be_is_given_up_and_looked_for() -> None:
    stage, eyes = at_start("push", "camera_state")
    world_of(stage).put("box", [-1.0, 0.0, 0.2])
    stage.step(STAND)
    operator = ScriptedOperator(PLAYS["push"], eyes.doubt)
    meant = [operator.mean(eyes.see(operator.meant)) for _ in range(70)]
    looks = [abs(intent.turn) == LOOKS_ROUND.turn for intent in meant]
    assert not any(looks[: round(MISSES_S / CONTROL_DT)])
    assert all(looks[round(MISSES_S / CONTROL_DT) + LATE + 2 :])
    assert "box" not in operator.sight.pos
    moved(stage, 0.0, 0.0, np.pi)
    assert off(stage, seen(eyes), "box") < 0.1
    assert operator.mean(eyes.see(operator.meant)).turn != LOOKS_ROUND.turn


def test_whoever_turned_in_vain_or_stands_too_near_walks_on() -> None:
    def looks(where: list[float]) -> list[bool]:
        """Whether they turn, a period each."""
        operator = ScriptedOperator(PLAYS["push"])
        lost = {"box": np.array(where), "mark": np.zeros(2)}
        sight = Sight(step="walk", base=np.zeros(3), yaw=0.0, turning=0.2, pos={}, lost=lost)
        meant = [operator.mean(sight) for _ in range(round((TURN_S + 10.0) / CONTROL_DT))]
        assert {np.sign(intent.turn) for intent in meant} == {0.0, np.sign(where[1])}
        return [intent.turn != 0.0 for intent in meant]

    far, near = looks([2.0, -0.5]), looks([0.3, 0.2])
    assert far.index(False) == pytest.approx(TURN_S / CONTROL_DT, abs=2)
    assert (near[0], near.index(True)) == (False, pytest.approx(ON_S / CONTROL_DT, abs=2))


def test_a_play_that_came_to_nothing_is_begun_again_where_a_place_was_only_believed() -> None:
    def once(me: ScriptedOperator, name: str):
        yield Intent(crouch=1.0)

    plays: dict[str, Callable] = {"walk": partial(once, name="box")}
    begun: dict[View, bool] = {"third_person": True, "camera": False}
    for view in begun:
        stage, eyes = at_start("push", view)
        moved(stage, 0.0, 0.0, np.pi)  # its back to the box
        operator = ScriptedOperator(plays, eyes.doubt)
        for _ in range(60):
            operator.mean(eyes.see(operator.meant))
        moved(stage, 0.0, 0.0, 0.0)
        meant = [operator.mean(eyes.see(operator.meant)) for _ in range(30)]
        begun[view] = any(intent.crouch == 1.0 for intent in meant)
    assert begun == {"third_person": False, "camera": True}


def test_rows_say_by_which_view_and_only_the_one_from_outside_has_a_goal() -> None:
    job = co.Job(scene="push", controller="policy", style="march", seed=0, view="camera")
    run = co.Run(steps=("walk",), done=(4.0,), score=1, failed="", seconds=4.0)
    row = co._whole([job], [run])
    assert (row["view"], row["goal"]) == ("camera", None)
