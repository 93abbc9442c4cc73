"""What may go wrong while a person drives, and what the robot does: the table of docs/safety.md.

Each row is acted out on a clock that tests turn by hand, and its times are held to there
(tests/live/test_live_safety_table.py). `python -m studio.live.safety_table` prints the page.
"""

import sys
from dataclasses import dataclass

from studio.control.drive_command import Reason
from studio.control.staleness import STAND_AFTER
from studio.live.safety import DEMO_LIES, OVERRUN_SHARE, OVERRUN_WINDOW, PAGE_LOST_AFTER
from studio.live.safety_of_robot import robot_side
from studio.robot.a1 import CONTROL_DT


@dataclass(frozen=True, kw_only=True)
class Row:
    """One thing that may happen. key: of its test. what: for people. does: the robot. within: s
    after it happened that the robot has begun to, on the loop's clock. reason: `reason` of the
    state. latched: it stays so until somebody resets and arms. then: how it goes on."""

    key: str
    what: str
    does: str
    within: float
    reason: Reason
    latched: bool
    then: str


_RESET = "reset (the robot stands up), then arm: it follows again over a second"
_ITSELF = "by itself, once "
_PERIOD = CONTROL_DT

ROWS: tuple[Row, ...] = (
    Row(
        key="stop",
        what="A stop: the page's button or Esc, the camera's page, `POST /api/stop`, the client",
        does="goes limp at once, joints damped; takes and mode stay as they are",
        within=_PERIOD,
        reason="stopped",
        latched=True,
        then=_RESET + "; what was sent before the stop was answered does not undo it",
    ),
    Row(
        key="fall",
        what="The robot falls (its trunk touches the ground, or lies on its side)",
        does="goes limp, joints damped",
        within=_PERIOD,
        reason="fallen",
        latched=True,
        then=_RESET + f"; the page's own demo stands up by itself after {DEMO_LIES:.0f} s",
    ),
    Row(
        key="nan",
        what="A policy, a mapper or the physics says something that is no number, or fails",
        does="goes limp, joints damped; nothing of that period reaches a motor",
        within=_PERIOD,
        reason="fault",
        latched=True,
        then=_RESET + "; if it fails again, choose another mapper or controller",
    ),
    Row(
        key="hidden",
        what="The person is not seen: out of the picture, a sensor's gap, a broken line",
        does="a march goes on as a stride ago, any other pose is kept; then it comes to a stand",
        within=STAND_AFTER,
        reason="stale",
        latched=False,
        then=_ITSELF + "the person is seen",
    ),
    Row(
        key="implausible",
        what="Frames that no person sends: wrong shape, no numbers, out of range, or old",
        does="refuses and counts each, and says why; the person counts as not seen",
        within=STAND_AFTER,
        reason="stale",
        latched=False,
        then=_ITSELF + "good frames come",
    ),
    Row(
        key="jump",
        what="A person who leaps about as no person does, at less than the 20 m/s from which on a "
        "frame is refused",
        does="moves no faster than its limits allow: joints, trunk and targets",
        within=0.0,
        reason="",
        latched=False,
        then="nothing to be done",
    ),
    Row(
        key="nobody",
        what="Nobody has been seen yet, or another sender begins",
        does="rests in its stance",
        within=_PERIOD,
        reason="nobody",
        latched=False,
        then=_ITSELF + "a person is seen",
    ),
    Row(
        key="ended",
        what="A clip, a take or a sensor's source comes to its end or fails",
        does="comes to a stand",
        within=_PERIOD,
        reason="source_ended",
        latched=False,
        then="play it again, or choose another source",
    ),
    Row(
        key="swap",
        what="Another source is chosen while the robot is driven",
        does="lets go of the old person in the same period; a sensor's person is not followed "
        "before somebody arms",
        within=_PERIOD,
        reason="idle",
        latched=False,
        then="arm",
    ),
    Row(
        key="page",
        what="The page in control is closed, hangs, or its line breaks",
        does="comes to a stand",
        within=PAGE_LOST_AFTER + _PERIOD,
        reason="page_lost",
        latched=False,
        then=_ITSELF + "the page is heard again; or whoever takes control or arms takes its place",
    ),
    Row(
        key="away",
        what="The page in control is out of sight: behind another tab, or minimised",
        does="is driven on; the page lets go of the keys that were held",
        within=0.0,
        reason="",
        latched=False,
        then="nothing to be done; another page may take control",
    ),
    Row(
        key="overrun",
        what="This computer is too slow: most periods of the last second were late",
        does="comes to a stand",
        within=OVERRUN_SHARE * OVERRUN_WINDOW * 2.0 * CONTROL_DT + 2.0 * CONTROL_DT,
        reason="overrun",
        latched=False,
        then=_ITSELF + "most periods of a second are in time",
    ),
    Row(
        key="limits",
        what="A target beyond a joint's range, or further away than 0.7 rad in a period; a torque "
        "beyond a motor's",
        does="gets the nearest that is allowed, in the same period, whatever asked for it",
        within=0.0,
        reason="",
        latched=False,
        then="nothing to be done",
    ),
    Row(
        key="disk",
        what="The disk is full, or a take cannot be written",
        does="is driven on; the take ends with what was written, and the page says so",
        within=0.0,
        reason="",
        latched=False,
        then="make room, record again",
    ),
)


def page() -> str:
    """docs/safety.md."""
    head = """# What stops the robot, and how it goes on

Made from the code by `make tables`; each row is acted out in a test. Times are from when it happens
to when the robot has begun to do it, on the control loop's clock (a period is 33 ms). `reason` is
in `GET /api/state`; the page shows `why` beside it, in words. *Stays so*: until somebody resets and
arms. A stop wins over every other row.

| what happens | the robot | within | `reason` | stays so | how it goes on |
|---|---|---|---|---|---|
"""
    rows = [
        f"| {row.what} | {row.does} | {_time(row.within)} | {_word(row.reason)} "
        f"| {'yes' if row.latched else 'no'} | {row.then} |"
        for row in ROWS
    ]
    tail = """
Ctrl C or SIGTERM ends the studio itself, and the simulated robot with it; a take that is being
recorded keeps what was written. A robot that can hurt somebody needs a switch of its own besides.
"""
    return head + "\n".join(rows) + "\n" + robot_side() + tail


def _word(reason: Reason) -> str:
    return f"`{reason}`" if reason else "–"


def _time(within: float) -> str:
    if within == 0.0:
        return "the same period"
    if within == CONTROL_DT:
        return "one period"
    return f"{within:.2g} s"


if __name__ == "__main__":
    sys.stdout.write(page())
