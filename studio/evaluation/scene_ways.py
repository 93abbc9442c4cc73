"""How the scripted operator gets the robot about: to what they see, round it, and to a halt."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.evaluation.scene_operator import STARTS_S, Meaning, ScriptedOperator
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

BRISK, SLOW = (0.75, 0.5), (0.5, 0.3)
"""(strides a second, lift) of marches that the robot follows at some 0.3 and 0.13 m/s."""
STEER, TURN = 1.2, 0.45
"""1/s: turn asked for of a bearing; rad/s, the most."""
FORESEES = 0.8
"""s for which a turn goes on after its operator has stopped asking for it."""
SHARP, SLUGGISH = 0.5, 0.25
"""rad off its way from which on a robot that turns by less, rad/s, is slowed: a smaller circle."""
NEAR, LEAD = 1.0, 0.15
"""m left from which a march is slow; that it still goes after its operator saw enough."""
CROSS = 1.2
"""rad/m: how much a heading is changed for being beside the line along which to push."""
ROOM = (1.2, 1.0)
"""m that whoever goes round something keeps behind and beside it."""
NUDGE_S, LONGER_S = 2.0, 0.4
"""s of a march that is meant as a step; s longer each time that it did not become one."""
AWAY, AGAIN, FACES = 2.4, 1.1, 0.3
"""rad that whoever went too far turns from it, m that they go away, and rad off its way from which
they come again."""


def walking(way: Array, pace: tuple[float, float] = BRISK, turning: float = 0.0) -> Intent:
    """March on towards something that is seen (ahead, to the left), while the robot is seen to turn
    (rad/s) and will for a while yet."""
    ahead = way[0] if np.hypot(*way) > 1.0 else max(way[0], 0.5)
    bearing = np.arctan2(way[1], ahead) - FORESEES * turning
    slowed = abs(bearing) > SHARP and abs(turning) < SLUGGISH
    return march(SLOW if slowed else pace, STEER * bearing)


def march(pace: tuple[float, float], turn: float = 0.0) -> Intent:
    """March, and turn (rad/s, > 0 left) as far as a person can."""
    turn = float(np.clip(turn, -TURN, TURN))
    return Intent(state="walk", task="walk", cadence=pace[0], lift=pace[1], turn=turn)


def set_off(me: ScriptedOperator) -> Meaning:
    """March straight on until the robot walks."""
    if me.meant.state != "walk":
        yield from wait(STARTS_S, march(SLOW))


def wait(seconds: float, intent: Intent | None = None) -> Meaning:
    """The same for a while."""
    for _ in range(round(seconds / CONTROL_DT)):
        yield intent or Intent()


def halt(me: ScriptedOperator) -> Meaning:
    """Stand until the robot has come to rest."""
    still, before = 0, me.sight.base
    yield from wait(0.8)
    for _ in range(150):
        yield Intent()
        way = float(np.linalg.norm(me.sight.base[:2] - before[:2]))
        before = 0.8 * before + 0.2 * me.sight.base
        still = still + 1 if way < 0.02 else 0
        if still > 12:
            return


def approach(
    me: ScriptedOperator,
    where: Callable[[], Array],
    ahead: float,
    close: float = 0.1,
    over: float = 0.1,
    beside: float = 0.3,
) -> Meaning:
    """Walk until a place (ahead, to the left) is `ahead` m ahead of the trunk, or `close` m more,
    and stop; step by step at last, and rather too few steps: nobody can march backward. Whoever
    went more than `over` m too far, or has it over `beside` m to a side, comes again."""
    while True:
        if where()[0] - ahead > LEAD + 0.5 * close:
            yield from set_off(me)
        while (left := where()[0] - ahead) > LEAD + 0.5 * close:
            yield walking(where(), SLOW if left < NEAR else BRISK, me.sight.turning)
        yield from halt(me)
        seconds = NUDGE_S
        # Straight on: asked to turn, a few steps turn the other way as the trunk turns back.
        while (left := where()[0] - ahead) > close:
            yield from wait(seconds, march(SLOW))
            yield from halt(me)
            if left - (where()[0] - ahead) < 0.02:
                seconds += LONGER_S
        if where()[0] - ahead > -over and abs(where()[1]) < beside:
            return
        yield from come_again(me, where)


def come_again(me: ScriptedOperator, where: Callable[[], Array]) -> Meaning:
    """Turn round and away from a place that the robot has walked past or beside, and back to it."""

    def bearing() -> float:
        return float(np.arctan2(*where()[::-1]))

    round_it = -TURN if bearing() > 0.0 else TURN
    yield from set_off(me)
    while abs(bearing()) < AWAY:
        yield march(SLOW, round_it)
    while np.hypot(*where()) < AGAIN:
        yield march(SLOW)
    while abs(bearing() - FORESEES * me.sight.turning) > FACES:
        yield march(SLOW, round_it)


def go_round(me: ScriptedOperator, name: str, way: Array) -> Meaning:
    """Walk back past something that is missed, on the side where the robot is, to well behind it
    on the line (2,) of its way."""
    side = float(np.sign(off_line(me, name, way)[1])) or 1.0
    beside_it = np.array([-way[1], way[0]]) * side * ROOM[1]
    while off_line(me, name, way)[0] > -ROOM[0]:
        back = me.sight.to(me.sight.pos[name][:2] - 2.0 * ROOM[0] * way + beside_it)
        yield walking(back, turning=me.sight.turning)


def along_line(
    me: ScriptedOperator, way: Array, beside: float, share: float, pace: tuple[float, float]
) -> Intent:
    """Walk the way (2,) of a line that is `beside` m to the right, with a share of the turn."""
    heading = np.arctan2(way[1], way[0]) - np.clip(CROSS * beside, -0.8, 0.8)
    bearing = share * float(geometry.wrap_angle(heading - me.sight.yaw))
    return walking(np.array([np.cos(bearing), np.sin(bearing)]), pace, me.sight.turning)


def off_line(me: ScriptedOperator, name: str, way: Array) -> tuple[float, float]:
    """m: how far the robot is along a way (2,) from something, and to the left of its line."""
    off = me.sight.base[:2] - me.sight.pos[name][:2]
    return float(way @ off), float(way[0] * off[1] - way[1] * off[0])
