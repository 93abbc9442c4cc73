"""What was decided about a take, as a log beside its tape: appended, replayed, undone, redone.

`edits.jsonl` holds a JSON object a line: {"time", "set": {field: value}} or {"time", "undo": true}
or {"time", "redo": true}; and {"time", "found": {field: value}} for what a review measured, which
nobody decided and nobody undoes. The tape is never touched.
"""

import math
import os
from dataclasses import dataclass, fields
from datetime import datetime
from itertools import pairwise
from pathlib import Path
from typing import Any

import msgspec

from studio.errors import StudioError, unknown_name
from studio.takes.names import check_name
from studio.takes.untrusted import decoded, read_bytes

EDITS = "edits.jsonl"
MOST_EDITS = 16 << 20
"""Bytes of a log; a line has some hundred, one that bends an hour's time a quarter of a million."""


@dataclass(frozen=True, kw_only=True)
class Edits:
    """The present value of every edit; None: never set.

    label. note. trim: (start, end) s into the take. lag: s by which the person is late (> 0), so
    that what belongs to the robot at t was acted at t + lag; 0: left as it is on purpose. warp:
    ((t, shift), ...) s, added to the lag at robot time t, linear between. cuts: ((start, end), ...)
    s left out, sorted and apart. splits: names of the takes that were split off the end, in order.
    keep: True kept, False rejected. score: [0, 1].
    """

    label: str | None = None
    note: str | None = None
    trim: tuple[float, float] | None = None
    lag: float | None = None
    warp: tuple[tuple[float, float], ...] | None = None
    cuts: tuple[tuple[float, float], ...] | None = None
    splits: tuple[str, ...] | None = None
    keep: bool | None = None
    score: float | None = None


FIELDS = tuple(f.name for f in fields(Edits))
MAX_LAG, MAX_ROWS = 10.0, 20_000
"""s; rows of a warp or of cuts."""


@dataclass(frozen=True, kw_only=True)
class EditLog:
    """Edits now, how many can be undone and redone, what was wrong with the log. readable: it could
    be read at all."""

    edits: Edits = Edits()
    undoable: int = 0
    redoable: int = 0
    problems: tuple[str, ...] = ()
    readable: bool = True


_Value = None | bool | float | str | list[float | str | list[float]]


class _Line(msgspec.Struct):
    """A line of the log; `_checked` says which values a field may have."""

    undo: bool = False
    redo: bool = False
    set: dict[str, _Value] | None = None
    found: dict[str, _Value] | None = None


_line = msgspec.json.Decoder(_Line)
_TOLD = 8
"""Damaged lines that are told of one by one."""


def read_edits(folder: Path) -> EditLog:
    """Replay a take's log. Damaged lines are left out and named in `problems`; of a log that cannot
    be read, or is too large to be one, nothing is used."""
    try:
        lines = read_bytes(folder / EDITS, MOST_EDITS).splitlines()
    except FileNotFoundError:
        return EditLog()
    except OSError as error:
        return EditLog(problems=(f"{EDITS} cannot be read: {error.strerror}",), readable=False)
    except ValueError as error:
        return EditLog(problems=(f"{EDITS} is left out: {error}",), readable=False)
    done: list[dict[str, Any]] = []
    undone: list[dict[str, Any]] = []
    problems: list[str] = []
    found: dict[str, Any] = {}
    for number, line in enumerate(lines, 1):
        try:
            row = decoded(line, _line)
            if row.undo:
                undone.append(done.pop())
            elif row.redo:
                done.append(undone.pop())
            elif row.found is not None:
                found |= _checked(row.found)
            else:
                done.append(_checked(row.set))
                undone.clear()
        except (ValueError, StudioError, IndexError) as error:
            problems.append(f"{EDITS} line {number} is left out: {error or 'damaged'}")
    values = found
    for changes in done:
        values = values | changes
    if len(problems) > _TOLD:
        problems[_TOLD:] = [f"and {len(problems) - _TOLD} lines more"]
    return EditLog(
        edits=Edits(**values), undoable=len(done), redoable=len(undone), problems=tuple(problems)
    )


def edit(folder: Path, **changes: Any) -> EditLog:
    """Set fields of Edits (None clears one) as one step that can be undone."""
    return _append(folder, {"set": _checked(changes)})


def record(folder: Path, **found: Any) -> EditLog:
    """Keep what was measured, until somebody decides otherwise; no step that could be undone."""
    return _append(folder, {"found": _checked(found)})


def undo(folder: Path) -> EditLog:
    """Take the last step back; StudioError if there is none."""
    if not read_edits(folder).undoable:
        raise StudioError(f"nothing to undo in take {folder.name}")
    return _append(folder, {"undo": True})


def redo(folder: Path) -> EditLog:
    """Do again what was last undone; StudioError if there is nothing."""
    if not read_edits(folder).redoable:
        raise StudioError(f"nothing to redo in take {folder.name}")
    return _append(folder, {"redo": True})


def _append(folder: Path, row: dict[str, Any]) -> EditLog:
    if not read_edits(folder).readable:
        raise StudioError(
            f"{EDITS} of take {folder.name} is damaged: move it away, then edit the take anew"
        )
    row = {"time": datetime.now().astimezone().isoformat(timespec="seconds")} | row
    line, path = msgspec.json.encode(row) + b"\n", folder / EDITS
    try:
        handle = os.open(path, os.O_RDWR | os.O_CREAT | os.O_APPEND, 0o644)
        try:
            size = os.fstat(handle).st_size
            if size + len(line) >= MOST_EDITS:
                raise StudioError(f"{EDITS} of take {folder.name} is full: export the take instead")
            # A line torn by a crash must not swallow the next one.
            torn = size > 0 and os.pread(handle, 1, size - 1) != b"\n"
            os.write(handle, (b"\n" if torn else b"") + line)
            os.fsync(handle)
        finally:
            os.close(handle)
        os.utime(folder)  # the library's index looks at the folder's time
    except OSError as error:
        raise StudioError(f"the edit of {folder.name} was not kept: {error.strerror}") from error
    return read_edits(folder)


def _checked(changes: Any) -> dict[str, Any]:
    if not isinstance(changes, dict) or not changes:
        raise StudioError(f"nothing to change: give one of {', '.join(FIELDS)}")
    return {key: _checked_value(key, value) for key, value in changes.items()}


def _checked_value(key: str, value: Any) -> Any:
    if key not in FIELDS:
        raise unknown_name("edit", key, FIELDS)
    if value is None:
        return None
    if key in ("label", "note"):
        if not isinstance(value, str) or len(value) > 10_000:
            raise StudioError(f"a {key} is text of at most 10,000 characters")
        return value
    if key == "keep":
        if not isinstance(value, bool):
            raise StudioError("keep is true or false")
        return value
    if key == "splits":
        return tuple(check_name(name) for name in _rows(key, value)) or None
    if key == "trim":
        return _stretch("a trim", value)
    if key == "cuts":
        cuts = [_stretch("a cut", row) for row in _rows(key, value)]
        return _joined(cuts) or None
    if key == "warp":
        warp = [_pair("a row of a warp", row) for row in _rows(key, value)]
        if any(b[0] <= a[0] for a, b in pairwise(warp)):
            raise StudioError("a warp is [[t, shift], ...] in seconds, t ascending")
        if any(b[0] + b[1] < a[0] + a[1] for a, b in pairwise(warp)):
            raise StudioError("a warp must not let the person's time run backwards")
        if any(abs(shift) > MAX_LAG for _, shift in warp):
            raise StudioError(f"a warp shifts by at most {MAX_LAG:g} s")
        return tuple(warp) or None
    number = _number(f"a {key}", value)
    if key == "score" and not 0.0 <= number <= 1.0:
        raise StudioError("a score is between 0 and 1")
    if key == "lag" and abs(number) > MAX_LAG:
        raise StudioError(f"a lag is at most {MAX_LAG:g} s")
    return number


def _rows(key: str, value: Any) -> list[Any] | tuple[Any, ...]:
    if not isinstance(value, list | tuple) or len(value) > MAX_ROWS:
        raise StudioError(f"{key} is a list of at most {MAX_ROWS} rows")
    return value


def _pair(what: str, value: Any) -> tuple[float, float]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise StudioError(f"{what} is two numbers, in seconds")
    return _number(what, value[0]), _number(what, value[1])


def _stretch(what: str, value: Any) -> tuple[float, float]:
    if not isinstance(value, list | tuple) or len(value) != 2:
        raise StudioError(f"{what} is [start, end] in seconds")
    start, end = _pair(what, value)
    if not 0.0 <= start < end:
        raise StudioError(f"{what} is [start, end] in seconds, 0 <= start < end")
    return start, end


def _joined(stretches: list[tuple[float, float]]) -> tuple[tuple[float, float], ...]:
    """Sorted; those that touch or overlap as one."""
    out: list[tuple[float, float]] = []
    for start, end in sorted(stretches):
        if out and start <= out[-1][1]:
            out[-1] = out[-1][0], max(end, out[-1][1])
        else:
            out.append((start, end))
    return tuple(out)


def _number(what: str, value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise StudioError(f"{what} is a finite number, in seconds")
    return float(value)
