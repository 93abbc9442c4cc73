"""How the scripted operator gets a robot about: on a robot of three numbers that goes as asked."""

from collections.abc import Callable
from functools import partial

import numpy as np
import pytest

from studio import geometry
from studio.evaluation.scene_operator import (
    LOOKS_ROUND,
    STALLED_S,
    STARTS_S,
    Meaning,
    ScriptedOperator,
    Sight,
)
from studio.evaluation.scene_plays import REACH_SIDE, SWINGS_S, at_rest, past_pole, push_to
from studio.evaluation.scene_ways import approach, come_again
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT

THING = np.array([0.0, 0.0, 0.5])
SPEED = {0.0: 0.0, 0.5: 0.13, 0.75: 0.3}
PLACES = {name: THING for name in ("thing", "box", "pole1", "mark")}
Play = Callable[[ScriptedOperator], Meaning]


class Robot:
    """It walks and turns with a lag, once it has been asked to for a while; the rest it ignores."""

    def __init__(self, x: float, y: float, yaw: float = 0.0, *, stuck: bool = False) -> None:
        self.base, self.yaw, self.stuck = np.array([x, y, 0.27]), yaw, stuck
        self._speed, self._turn, self._marched = 0.0, 0.0, 0.0

    def sight(self, pos: dict[str, np.ndarray]) -> Sight:
        return Sight(
            step="go", base=self.base.copy(), yaw=self.yaw, turning=self._turn, pos=pos,
            places={"mark": THING[:2] + [1.0, 0.0]},
        )  # fmt: skip

    def follow(self, meant: Intent) -> None:
        self._marched = self._marched + CONTROL_DT if meant.state == "walk" else 0.0
        goes = self._marched > 1.0 and not self.stuck
        share = CONTROL_DT / 0.3
        self._speed += share * (goes * SPEED[meant.cadence] - self._speed)
        self._turn += share * (goes * 0.57 * meant.turn - self._turn)
        self.yaw = float(geometry.wrap_angle(self.yaw + self._turn * CONTROL_DT))
        ahead = np.array([np.cos(self.yaw), np.sin(self.yaw), 0.0])
        self.base = self.base + self._speed * CONTROL_DT * ahead


def driven(play: Play, robot: Robot, seconds: float = 90.0) -> list[Intent]:
    """What was meant until the play had no more to try."""
    over = False

    def to_the_end(me: ScriptedOperator) -> Meaning:
        nonlocal over
        yield from play(me)
        over = True

    operator, meant = ScriptedOperator({"go": to_the_end}), []
    while not over and len(meant) < seconds / CONTROL_DT:
        meant.append(operator.mean(robot.sight(PLACES)))
        robot.follow(meant[-1])
    return meant


def near(me: ScriptedOperator) -> Meaning:
    return approach(me, lambda: me.sight.of("thing"), 0.4, beside=REACH_SIDE)


def left_of(robot: Robot) -> np.ndarray:
    """(2,) m, where the thing is from the robot."""
    return geometry.turn_xy(THING[:2] - robot.base[:2], -robot.yaw)


STARTS = (
    (-2.0, 0.0), (-2.0, 0.4), (-0.2, 0.0), (-0.45, 0.3), (-0.45, -0.3), (-0.46, 0.2, -0.7),
    (0.5, 0.1),
)  # fmt: skip


@pytest.mark.parametrize("start", STARTS)
def test_whoever_approaches_comes_to_stand_before_it_from_wherever(
    start: tuple[float, ...],
) -> None:
    """Also from too near, from beside it, turned away, and from beyond it."""
    robot = Robot(*start)
    meant = driven(near, robot)
    assert len(meant) < 90.0 / CONTROL_DT
    ahead, left = left_of(robot)
    assert 0.3 < ahead <= 0.5
    assert abs(left) < REACH_SIDE
    assert meant[-1].state == "stand"


def test_who_stands_well_does_not_come_again() -> None:
    robot = Robot(-0.45, 0.1)
    assert {intent.state for intent in driven(near, robot)} == {"stand"}
    assert np.allclose(robot.base[:2], [-0.45, 0.1])


def test_the_last_steps_are_not_asked_to_turn() -> None:
    """A few steps asked to turn turn the other way."""
    robot = Robot(-0.58, 0.15)
    marched = [intent for intent in driven(near, robot) if intent.state == "walk"]
    assert marched
    assert {intent.turn for intent in marched} == {0.0}


@pytest.mark.parametrize(
    "play",
    [
        near,
        partial(come_again, where=lambda: np.array([0.3, -0.3])),
        partial(past_pole, pole="pole1", aside=0.5),
        partial(push_to, name="box", mark="mark"),
    ],
)
def test_nobody_turns_before_the_robot_walks(play: Play) -> None:
    meant = driven(play, Robot(-2.0, 1.0), seconds=STARTS_S + 1.0)
    starts = round(STARTS_S / CONTROL_DT)
    assert all(intent.state == "walk" for intent in meant)
    assert {intent.turn for intent in meant[:starts]} == {0.0}
    assert meant[-1].turn != 0.0


def turning_on(me: ScriptedOperator) -> Meaning:
    while True:
        yield LOOKS_ROUND


def test_whoever_sees_the_robot_stop_marches_straight_on_before_they_turn_again() -> None:
    turns = [i.turn != 0.0 for i in driven(turning_on, Robot(0.0, 0.0, stuck=True), 20.0)]
    stops = round(STALLED_S / CONTROL_DT)
    assert all(turns[:stops])
    assert not any(turns[stops + 2 : stops + round(STARTS_S / CONTROL_DT) - 2])
    assert any(turns[stops + round(STARTS_S / CONTROL_DT) :])


def test_whoever_sees_the_robot_turn_goes_on_turning() -> None:
    assert all(intent.turn for intent in driven(turning_on, Robot(0.0, 0.0), 20.0))


def test_what_swings_is_waited_for_until_it_rests_and_not_for_ever() -> None:
    def periods(swing: Callable[[int], float]) -> int:
        operator, robot, over = ScriptedOperator({}), Robot(0.0, 0.0), 0
        operator.sight = robot.sight({"thing": THING + [swing(0), 0.0, 0.0]})
        for over, _ in enumerate(at_rest(operator, "thing"), start=1):
            operator.sight = robot.sight({"thing": THING + [swing(over), 0.0, 0.0]})
        return over

    second = round(1.0 / CONTROL_DT)
    assert periods(lambda k: 0.0) == second
    assert periods(lambda k: 0.0 if k < 20 else 0.2) == 2 * second
    assert periods(lambda k: 0.01 * k if k < 60 else 0.6) >= 60 + second
    assert periods(lambda k: 0.01 * k) == pytest.approx(SWINGS_S / CONTROL_DT, abs=2)
