"""How the scripted operator does each step of each scene: what they see to what they mean.

A play is a generator: an Intent each control period. It ends when it has no more to try; then the
operator stands and waits.
"""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.evaluation.scene_operator import Meaning, ScriptedOperator
from studio.reference.intent import Intent
from studio.robot.a1 import CONTROL_DT
from studio.scenes import slalom

Array = NDArray[np.float64]
Play = Callable[[ScriptedOperator], Meaning]

BRISK, SLOW = (0.75, 0.5), (0.5, 0.3)
"""(strides a second, lift) of marches that the robot follows at some 0.25 and 0.13 m/s."""
STEER, TURN = 1.2, 0.45
"""1/s: turn asked for of a bearing; rad/s, the most."""
FORESEES = 0.8
"""s for which a turn goes on after its operator has stopped asking for it."""
NEAR, LEAD = 0.5, 0.12
"""m left from which a march is slow; that it still goes after its operator saw enough."""
PUSHES = 0.55
"""m behind the middle of what is pushed: from here on turn little, or it slips off."""
CROSS = 1.2
"""rad/m: how much a heading is changed for being beside the line along which to push."""
LOST, SLIPPED = -0.15, 0.3
"""m along the way from what is pushed, and m beside it, from which on it is no longer ahead."""
ROOM = (1.2, 1.0)
"""m that whoever goes round something keeps behind and beside it."""
HELD_S = 3.5
"""s that what was pushed is looked at before it is pushed again."""
CLOSER = 0.03
"""m that whoever sat too far off goes nearer the next time."""
ASIDE = 0.15
"""m to a side from which also a few steps are asked to turn."""
NUDGE_S, LONGER_S = 1.5, 0.3
"""s of a march that is meant as a step; s longer each time that it did not become one."""
SITS = 0.32
"""m: a trunk that is higher sits."""


def walking(way: Array, pace: tuple[float, float] = BRISK, turning: float = 0.0) -> Intent:
    """March on towards something that is seen (ahead, to the left), while the robot is seen to turn
    (rad/s) and will for a while yet."""
    ahead = way[0] if np.hypot(*way) > 1.0 else max(way[0], 0.5)
    bearing = np.arctan2(way[1], ahead) - FORESEES * turning
    turn = float(np.clip(STEER * bearing, -TURN, TURN))
    return Intent(state="walk", task="walk", cadence=pace[0], lift=pace[1], turn=turn)


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
    me: ScriptedOperator, where: Callable[[], Array], ahead: float, close: float = 0.1
) -> Meaning:
    """Walk until a place (ahead, to the left) is `ahead` m ahead of the trunk, or `close` m more,
    and stop; step by step at last, and rather too few steps: nobody can march backward."""
    while (left := where()[0] - ahead) > LEAD + 0.5 * close:
        yield walking(where(), SLOW if left < NEAR else BRISK, me.sight.turning)
    yield from halt(me)
    seconds = NUDGE_S
    while (left := where()[0] - ahead) > close:
        # Straight on, unless it is well to a side: a few steps asked to turn turn too far.
        way = where() if abs(where()[1]) > ASIDE else np.array([1.0, 0.0])
        yield from wait(seconds, walking(way, SLOW))
        yield from halt(me)
        if left - (where()[0] - ahead) < 0.02:
            seconds += LONGER_S


# Steps that scenes share ---------------------------------------------------------------------


def greet(me: ScriptedOperator) -> Meaning:
    """Lean to the right, then to the left, until it was seen."""
    yield from wait(1.0)
    while True:
        yield from wait(2.0, Intent(task="tilt", tilt=np.array([0.4, 0.0, 0.0])))
        yield from wait(2.0, Intent(task="tilt", tilt=np.array([-0.4, 0.0, 0.0])))


def walk_to(me: ScriptedOperator, mark: str) -> Meaning:
    """Walk onto a mark and stand there."""
    yield from approach(me, lambda: me.sight.to(me.sight.spot(mark)), 0.0)


def duck(me: ScriptedOperator) -> Meaning:
    """Crouch while the ball may come."""
    while True:
        yield Intent(task="crouch", crouch=1.0)


def touch_standing(me: ScriptedOperator, name: str) -> Meaning:
    """Go near, raise the paw of the side that it is on, and feel for it."""
    while True:
        yield from approach(me, lambda: me.sight.of(name), 0.40)
        for k in range(4):
            left = me.sight.of(name)[1]
            paw = 1 if left > 0.0 else 0
            side = float(np.clip((left - (0.1 if paw else -0.1)) / 0.25, -1.0, 1.0))
            for share in np.linspace(0.0, 1.0, 60):
                reach = np.zeros(2)
                reach[paw] = 0.3 + 0.6 * np.sin(np.pi * share)
                sides = np.zeros(2)
                sides[paw] = np.clip(side + (0.0, 0.3, -0.3, 0.0)[k], -1.0, 1.0)
                yield Intent(task="manipulate", reach=reach, reach_side=sides)
        yield from halt(me)


def touch_sitting(
    me: ScriptedOperator, name: str, ahead: float, close: float = 0.1, aside: float = 0.0
) -> Meaning:
    """Go under it, sit, and feel for it with both paws; or, where it is to be `aside` m to the
    left, with that of its side."""
    while True:
        if me.sight.base[2] < SITS:
            yield from approach(me, lambda: me.sight.of(name) - [0.0, aside], ahead, close)
        for _ in range(300):
            yield Intent(state="sit", task="sit_quiet")
            if me.sight.base[2] > SITS:
                break
        yield from wait(1.0, Intent(state="sit", task="sit_quiet"))
        paws = np.array([aside <= 0.0, aside >= 0.0])
        for pitch, off in ((0.0, 0.0), (0.12, 0.0), (0.24, 0.0), (0.05, 0.06), (0.05, -0.06)):
            beside = me.sight.of(name)[1] - aside + off
            sides = np.clip(np.where(paws, beside / 0.13, 0.0), -1.0, 1.0)
            for share in np.linspace(0.0, 1.0, 110):
                reach = paws * np.sin(np.pi * share) ** 0.7
                tilt = np.array([0.0, pitch, 0.0])
                yield Intent(
                    state="sit", task="sit_manipulate", reach=reach, reach_side=sides, tilt=tilt
                )
        ahead -= CLOSER
        yield from wait(4.0)
        me.doubt(name)


def push_to(me: ScriptedOperator, name: str, mark: str) -> Meaning:
    """Walk into it from behind, on the line from it to the mark, until it is nearly there; around
    it and again where it slipped off, or went too far."""
    way = np.array([1.0, 0.0])
    while True:
        gap = me.sight.spot(mark) - me.sight.pos[name][:2]
        left = float(np.linalg.norm(gap))
        if left < 2.0 * LEAD or 0.0 > way @ gap > -NEAR:
            yield from halt(me)
            yield from wait(HELD_S)
            me.doubt(name)
            gap = me.sight.spot(mark) - me.sight.pos[name][:2]
            way = gap / np.linalg.norm(gap)
            continue
        if left > NEAR:
            way = gap / left
        along, beside = _from(me, name, way)
        if along > LOST or (left > NEAR and along > -PUSHES and abs(beside) > SLIPPED):
            yield from go_round(me, name, way)
            continue
        yield along_line(me, way, beside, 0.5 if along > -PUSHES else 1.0, SLOW)


def go_round(me: ScriptedOperator, name: str, way: Array) -> Meaning:
    """Walk back past something that is missed, on the side where the robot is, to well behind it
    on the line (2,) of its way."""
    side = float(np.sign(_from(me, name, way)[1])) or 1.0
    beside_it = np.array([-way[1], way[0]]) * side * ROOM[1]
    while _from(me, name, way)[0] > -ROOM[0]:
        back = me.sight.to(me.sight.pos[name][:2] - 2.0 * ROOM[0] * way + beside_it)
        yield walking(back, turning=me.sight.turning)


def along_line(
    me: ScriptedOperator, way: Array, beside: float, share: float, pace: tuple[float, float]
) -> Intent:
    """Walk the way (2,) of a line that is `beside` m to the right, with a share of the turn."""
    heading = np.arctan2(way[1], way[0]) - np.clip(CROSS * beside, -0.8, 0.8)
    bearing = share * float(geometry.wrap_angle(heading - me.sight.yaw))
    return walking(np.array([np.cos(bearing), np.sin(bearing)]), pace, me.sight.turning)


def _from(me: ScriptedOperator, name: str, way: Array) -> tuple[float, float]:
    """m: how far the robot is along a way (2,) from something, and to the left of its line."""
    off = me.sight.base[:2] - me.sight.pos[name][:2]
    return float(way @ off), float(way[0] * off[1] - way[1] * off[0])


def past_pole(me: ScriptedOperator, pole: str, aside: float) -> Meaning:
    """Beside a pole, along x, then on."""
    for off in (-0.4, 0.4):
        while (place := me.sight.pos[pole][:2] + [off, aside])[0] > me.sight.base[0]:
            yield walking(me.sight.to(place), turning=me.sight.turning)


def straight(me: ScriptedOperator, mark: str) -> Meaning:
    """On along the middle, over a mark and beyond."""
    while True:
        x, y = me.sight.spot(mark)
        ahead = me.sight.to(np.array([max(x + 0.3, float(me.sight.base[0]) + 1.0), y]))
        yield walking(ahead, turning=me.sight.turning)


PLAYS: Mapping[str, Mapping[str, Play]] = {
    "greeting": {
        "greet": greet,
        "walk": partial(walk_to, mark="mark"),
        "dodge": duck,
        "touch": partial(touch_standing, name="target"),
        "reach": partial(touch_sitting, name="high", ahead=-0.12),
    },
    "hardware": {
        "hit": partial(touch_sitting, name="tennis", ahead=0.02, close=0.04, aside=-0.13),
        "touch": partial(touch_sitting, name="bone", ahead=-0.08),
        "dodge": duck,
    },
    "push": {step: partial(push_to, name="box", mark="mark") for step in ("walk", "push")},
    "slalom": {
        **{
            pole.name: partial(past_pole, pole=pole.name, aside=0.5 * side)
            for pole, side in zip(slalom.POLES, slalom.SIDES, strict=True)
        },
        "finish": partial(straight, mark="mark"),
    },
    "rough": {name: partial(straight, mark="mark") for name in ("stairs", "slope", "bumps")},
    "fetch": {step: partial(push_to, name="ball", mark="net") for step in ("reach", "goal")},
}
"""For each scene, how each of its steps is done."""
