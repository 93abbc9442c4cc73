"""What a robot behind a link does by itself: the second table of docs/safety.md.

Times and angles are those of the robot's side (`link.robot_side`, `link.guards`); each row is acted
out in a test.
"""

import math
from dataclasses import dataclass

from studio.link.guards import LEANS, OVERTURNED
from studio.link.robot_side import HALT_AFTER, HOLD_AFTER, SIT_AFTER, TO_BELLY


@dataclass(frozen=True, kw_only=True)
class RobotRow:
    """One thing that may happen. key: of its test. what: for people. does: the robot. within: s of
    its own clock, from the last order that it heard; 0: in its next step. latched: it is limp until
    it is asked to rise."""

    key: str
    what: str
    does: str
    within: float
    latched: bool


_LIMP = "goes limp, joints damped"
_SITS = f"sits down onto its belly in {TO_BELLY:g} s, then {_LIMP}"
_LEANS, _PAST = (round(math.degrees(math.asin(sine))) for sine in (LEANS, -OVERTURNED))
_FALLEN = f"It leans over {_LEANS}° to a side or nose down, or nose up {_PAST}° past the vertical"
_STANDS = f"comes to a stand by its own policy; after {SIT_AFTER['references']:g} s it {_SITS}"

ROBOT_ROWS: tuple[RobotRow, ...] = (
    RobotRow(
        key="late",
        what="No order comes",
        does="keeps its last target, or reference",
        within=HOLD_AFTER,
        latched=False,
    ),
    RobotRow(
        key="silent_targets",
        what="The line stays silent, level `targets`",
        does=_SITS,
        within=SIT_AFTER["targets"],
        latched=True,
    ),
    RobotRow(
        key="silent_references",
        what="The line stays silent, level `references`",
        does=_STANDS,
        within=HALT_AFTER,
        latched=True,
    ),
    RobotRow(
        key="tilt",
        what=_FALLEN,
        does=_LIMP,
        within=0.0,
        latched=True,
    ),
    RobotRow(
        key="not_finite",
        what="A sensor of it says what is no number",
        does=_LIMP,
        within=0.0,
        latched=True,
    ),
)


def robot_side() -> str:
    """Its part of docs/safety.md."""
    head = """
## The robot's own side of a link

A robot behind a [link](robot-link.md) trusts nobody. Whatever the studio says, or does not say,
its own process does this, on its own clock; times are from the last order that it heard. *Stays
so*: limp until it is asked to rise (in the studio: reset, then arm), and only if its start-up check
passes. An order that is malformed, old or not finite is refused, and counts as none.

| what happens | the robot | within | stays so |
|---|---|---|---|
"""
    return head + "".join(
        f"| {row.what} | {row.does} | {f'{row.within:g} s' if row.within else 'its next step'} "
        f"| {'yes' if row.latched else 'no'} |\n"
        for row in ROBOT_ROWS
    )
