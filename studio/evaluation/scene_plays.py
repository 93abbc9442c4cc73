"""How the scripted operator does each step of each scene: what they see to what they mean.

A play is a generator: an Intent each control period. It ends when it has no more to try; then the
operator stands and waits.
"""

from collections.abc import Callable, Mapping
from functools import partial

import numpy as np
from numpy.typing import NDArray

from studio.evaluation.scene_operator import Meaning, ScriptedOperator
from studio.evaluation.scene_ways import (
    SLOW,
    along_line,
    approach,
    go_round,
    halt,
    off_line,
    set_off,
    wait,
    walking,
)
from studio.reference.intent import Intent
from studio.scenes import slalom

Array = NDArray[np.float64]
Play = Callable[[ScriptedOperator], Meaning]

PUSHES = 0.55
"""m behind the middle of what is pushed: from here on turn little, or it slips off."""
LOST, SLIPPED = -0.15, 0.3
"""m along the way from what is pushed, and m beside it, from which on it is no longer ahead."""
THERE, LAST = 0.24, 0.5
"""m from its mark at which what is pushed is left; from which on the way to it is kept."""
HELD_S = 3.5
"""s that what was pushed is looked at before it is pushed again."""
CLOSER = 0.03
"""m that whoever sat too far off goes nearer the next time."""
SITS = 0.32
"""m: a trunk that is higher sits."""
REACH_SIDE = 0.17
"""m beside the robot to which a standing one's paws reach."""
LEANS_M, LEANS = 0.35, 0.2
"""m above the seat at which sitting paws feel; rad that they lean to a side at most."""
SEAT = (0.15, 0.45)
"""m ahead of a robot that sits, between which it may reach what hangs; else it stands up again."""
TOO_FAR, TOO_WIDE = 0.05, 0.13
"""m from which on a sitting paw misses what hangs behind or beside it."""
RESTS, SWINGS_S = 0.02, 8.0
"""m that what hangs moves in half a second, at most, once it is at rest; s to wait for that."""

# Steps that scenes share ---------------------------------------------------------------------


def greet(me: ScriptedOperator) -> Meaning:
    """Lean to the right, then to the left, until it was seen."""
    yield from wait(1.0)
    while True:
        yield from wait(2.0, Intent(task="tilt", tilt=np.array([0.4, 0.0, 0.0])))
        yield from wait(2.0, Intent(task="tilt", tilt=np.array([-0.4, 0.0, 0.0])))


def walk_to(me: ScriptedOperator, mark: str) -> Meaning:
    """Walk onto a mark's near half and stand there: what comes next lies ahead."""
    yield from approach(me, lambda: me.sight.to(me.sight.spot(mark)), 0.2)


def duck(me: ScriptedOperator) -> Meaning:
    """Crouch while the ball may come."""
    while True:
        yield Intent(task="crouch", crouch=1.0)


def touch_standing(me: ScriptedOperator, name: str) -> Meaning:
    """Go near, raise the paw of the side that it is on, and feel for it."""
    while True:
        yield from approach(me, lambda: me.sight.of(name), 0.40, beside=REACH_SIDE)
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
    left, with that of its side. Lean to where it hangs: sitting paws hardly move sideways."""
    wide = TOO_WIDE if aside else 2.0 * TOO_WIDE
    while True:
        if me.sight.base[2] > SITS and not SEAT[0] < me.sight.of(name)[0] < SEAT[1]:
            yield from wait(4.0)
        if me.sight.base[2] < SITS:
            yield from approach(
                me, lambda: me.sight.of(name) - [0.0, aside], ahead, close, TOO_FAR, wide
            )
        for _ in range(300):
            yield Intent(state="sit", task="sit_quiet")
            if me.sight.base[2] > SITS:
                break
        yield from wait(1.0, Intent(state="sit", task="sit_quiet"))
        paws = np.array([aside <= 0.0, aside >= 0.0])
        for pitch, off in ((0.0, 0.0), (0.12, 0.0), (0.24, 0.0), (0.05, 0.06), (0.05, -0.06)):
            beside = me.sight.of(name)[1] - aside + off
            sides = np.clip(np.where(paws, beside / 0.13, 0.0), -1.0, 1.0)
            tilt = np.array([np.clip(-beside / LEANS_M, -LEANS, LEANS), pitch, 0.0])
            for share in np.linspace(0.0, 1.0, 110):
                reach = paws * np.sin(np.pi * share) ** 0.7
                yield Intent(
                    state="sit", task="sit_manipulate", reach=reach, reach_side=sides, tilt=tilt
                )
        ahead -= CLOSER
        yield from wait(4.0)
        yield from at_rest(me, name)
        me.doubt(name)


def at_rest(me: ScriptedOperator, name: str) -> Meaning:
    """Stand until what hangs there swings no more: at the end of a swing, too, it rests."""
    rested = 0
    for _ in range(round(2.0 * SWINGS_S)):
        before = me.sight.pos.get(name)
        yield from wait(0.5)
        now = me.sight.pos.get(name)
        if before is None or now is None:
            return
        rested = rested + 1 if np.linalg.norm(now - before) < RESTS else 0
        if rested == 2:
            return


def push_to(me: ScriptedOperator, name: str, mark: str) -> Meaning:
    """Walk into it from behind, on the line from it to the mark, until it is nearly there; around
    it and again where it slipped off, or went too far."""
    way = np.array([1.0, 0.0])
    yield from set_off(me)
    while True:
        gap = me.sight.spot(mark) - me.sight.pos[name][:2]
        left = float(np.linalg.norm(gap))
        if left < THERE or 0.0 > way @ gap > -LAST:
            yield from halt(me)
            yield from wait(HELD_S)
            me.doubt(name)
            gap = me.sight.spot(mark) - me.sight.pos[name][:2]
            way = gap / np.linalg.norm(gap)
            continue
        if left > LAST:
            way = gap / left
        along, beside = off_line(me, name, way)
        if along > LOST or (left > LAST and along > -PUSHES and abs(beside) > SLIPPED):
            yield from go_round(me, name, way)
            continue
        yield along_line(me, way, beside, 0.5 if along > -PUSHES else 1.0, SLOW)


def past_pole(me: ScriptedOperator, pole: str, aside: float) -> Meaning:
    """Beside a pole, along x, then on."""
    yield from set_off(me)
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
        "hit": partial(touch_sitting, name="tennis", ahead=0.03, close=0.04, aside=-0.13),
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
