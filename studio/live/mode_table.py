"""What changes the mode, and to which: the table of docs/modes.md.

Each cell is acted out (tests/live/test_live_mode_table.py); `python -m studio.live.mode_table`
prints the page.
"""

import sys
from dataclasses import dataclass
from typing import Literal

From = Literal["idle", "waiting", "live", "replay", "collect"]
"""A mode to come from; waiting: idle only because the source's person has not been armed yet."""
FROM: dict[From, str] = {
    "idle": "idle",
    "waiting": "idle, a live source not armed yet",
    "live": "live",
    "replay": "replay",
    "collect": "collect",
}
STAYS = "–"
REFUSED = "refused"


@dataclass(frozen=True, kw_only=True)
class Event:
    """key: of its test. what: for people. to: the mode it leads to from each of FROM in turn, or
    STAYS, or REFUSED. why: what is refused is told, a part of it. note: what else it does."""

    key: str
    what: str
    to: tuple[str, str, str, str, str]
    why: str = ""
    note: str = ""


EVENTS: tuple[Event, ...] = (
    Event(
        key="idle",
        what="idle is chosen",
        to=("–", "–", "idle", "idle", "idle"),
        note="the robot comes to a stand and rests; a running take of a plan is thrown away, any "
        "other goes on",
    ),
    Event(
        key="live",
        what="live is chosen",
        to=("live", "live", "–", "live", "live"),
        note="it follows the source as soon as it is armed; out of collect, who was watched before "
        "goes on",
    ),
    Event(
        key="replay",
        what="replay is chosen",
        to=("replay", "replay", "replay", "–", "replay"),
        note="the take that is watched, else the last recorded, is shown as it was",
    ),
    Event(
        key="replay_nothing",
        what="replay, where no take is watched or was recorded",
        to=(REFUSED, REFUSED, REFUSED, STAYS, REFUSED),
        why="nothing to replay",
    ),
    Event(
        key="collect",
        what="collect is chosen",
        to=("collect", "collect", "collect", "collect", "–"),
        note="motions are shown; in place of the built-in operator somebody acts who follows them",
    ),
    Event(
        key="collect_recording",
        what="collect, while a take is recorded by hand",
        to=(REFUSED, REFUSED, REFUSED, STAYS, STAYS),
        why="being recorded",
        note="in replay and collect none is",
    ),
    Event(
        key="replay_recording",
        what="replay, while a take is recorded by hand",
        to=(REFUSED, REFUSED, REFUSED, STAYS, STAYS),
        why="being recorded",
    ),
    Event(
        key="file",
        what="a source that starts by itself (the operator, a file, a take)",
        to=("live", "live", "–", "live", REFUSED),
        why="choose mode live first",
        note="armed, unless the robot is stopped",
    ),
    Event(
        key="stream",
        what="a source that waits for somebody (a camera, a stream, an app)",
        to=("–", "–", "idle", "idle", REFUSED),
        why="choose mode live first",
        note="not armed",
    ),
    Event(
        key="arm",
        what="arm",
        to=("–", "live", "–", "–", "–"),
        note="refused while the robot is down, in any mode: reset comes first",
    ),
    Event(
        key="stop",
        what="a stop, or a fall",
        to=("–", "–", "–", "–", "–"),
        note="a take of a plan is thrown away, a shown take paused; see [safety.md](safety.md)",
    ),
    Event(key="reset", what="reset", to=("–", "–", "–", "–", "–")),
    Event(
        key="record",
        what="recording is begun by hand",
        to=("–", "–", "–", REFUSED, REFUSED),
        why="choose mode live",
    ),
    Event(
        key="page_lost",
        what="the page that drives is closed",
        to=("–", "–", "–", "–", "–"),
        note="the robot stands until a page is there again; see [safety.md](safety.md)",
    ),
)


def page() -> str:
    """docs/modes.md."""
    head = f"""# Modes, and what changes them

Made from the code by `make tables`; each cell is acted out in a test. The mode says what the robot
does while nothing stops it: **idle**, it rests; **live**, it follows the person; **replay**, a take
is shown; **collect**, motions are shown and people act them out. Whether it may move at all is
another matter ([safety.md](safety.md)). `{STAYS}`: the mode stays as it is. *Refused*: nothing
changes, and the answer says why.

| what happens | {" | ".join(FROM.values())} | besides |
|---|---|---|---|---|---|---|
"""
    rows = (f"| {e.what} | {' | '.join(e.to)} | {e.note} |" for e in EVENTS)
    return head + "\n".join(rows) + "\n"


if __name__ == "__main__":
    sys.stdout.write(page())
