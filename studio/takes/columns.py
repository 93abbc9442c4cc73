"""A tape's streams as one table on disk, a row per tick: built once, then read by window.

The tape stays the truth; the table is a cache beside the library (`.cache/NAME.*`), rebuilt when
the tape changes. An hour is about 90 MB of it and is never read whole: numpy maps the file, and
whoever needs all of it goes through it in blocks.
"""

import contextlib
import os
import threading
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.files import whole, write_whole
from studio.human.pose import HumanPose
from studio.human.skeleton import NUM_JOINTS
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.record import codec
from studio.takes.record.meta import TAPE
from studio.takes.record.tape import TapeScan
from studio.takes.tick import STREAMS, Field, Tick, fields_in
from studio.takes.untrusted import read_json

CACHE = ".cache"
_NAMED = 40
"""Characters of a name that are kept."""


def _kind(field: Field) -> tuple:
    """A field as a column; what has a name is an index into Columns.names."""
    if field.shape is not None:
        return (field.column, "f4", field.shape)
    if field.keys:
        return (field.column, "f4", (len(field.keys),))  # NaN where a key is missing
    return (field.column, {float: "f8", bool: "?", int: "i8"}.get(codec.bare(field.type), "u1"))


_FIELDS = {stream: fields_in("columns", stream) for stream in STREAMS}
ROW = np.dtype([("fresh", "?"), *(_kind(f) for fields in _FIELDS.values() for f in fields)])
"""A row. fresh: a new pose came with this tick. human_t: s, the source's own clock; NaN before the
first pose, as the person's joints. The rest as in `tick.FIELDS`."""
VERSION = zlib.crc32(repr(ROW.descr).encode())
_BLOCK = 1024
_building = threading.Lock()


_PARSE = {stream: codec.parser("columns", stream) for stream in STREAMS}


@dataclass(frozen=True, kw_only=True)
class Columns:
    """rows: (T,) of dtype ROW, mapped from disk. names: of states and experts, by index.

    problem: why the tape ended early, or "". Without a human pose so far a row's human is NaN.
    """

    rows: NDArray[Any]
    names: tuple[str, ...]
    problem: str = ""

    def __len__(self) -> int:
        return len(self.rows)

    @property
    def seconds(self) -> float:
        """Duration, s."""
        return len(self.rows) / a1.CONTROL_HZ

    def blocks(self, size: int, overlap: int = 0) -> Iterator[tuple[int, NDArray[Any]]]:
        """(first row, rows) in order; each block also holds `overlap` rows of the next."""
        for start in range(0, len(self.rows), size):
            yield start, self.rows[start : start + size + overlap]


def columns(folder: Path) -> Columns:
    """The table of a take's folder, built now if there is none yet for this tape.

    Raises StudioError when there is no tape or nothing can be read. A cache that cannot be
    written costs time only.
    """
    tape = folder / TAPE
    try:
        key = _key(tape)
    except OSError as error:
        raise StudioError(f"take {folder.name} has no tape: {error.strerror}") from error
    base = folder.parent / CACHE / folder.name
    known = _load(base, key)
    if known is not None:
        return known
    with _building:  # whoever asks meanwhile waits for the one table
        known = _load(base, key)
        if known is not None:
            return known
        with contextlib.suppress(OSError):
            base.parent.mkdir(exist_ok=True)
            _build(tape, base, key)
            known = _load(base, key)
            if known is not None and known.problem:
                os.utime(folder)  # the library's index looks at the folder's time, and says so
            if known is not None:
                return known
    return _in_memory(tape)


def known_problem(folder: Path) -> str:
    """Why a take's tape ends early, where its table was built and tells; else ""."""
    try:
        about = read_json((folder.parent / CACHE / folder.name).with_suffix(".json"), _about)
        return about.problem if about.key == _key(folder / TAPE) else ""
    except (OSError, ValueError):
        return ""


def _key(tape: Path) -> list[int]:
    about = tape.stat()
    return [VERSION, about.st_size, about.st_mtime_ns]


def _load(base: Path, key: list[int]) -> Columns | None:
    try:
        about = read_json(base.with_suffix(".json"), _about)
        if (
            about.key != key
            or base.with_suffix(".rows").stat().st_size != about.rows * ROW.itemsize
        ):
            return None
        # An empty file cannot be mapped.
        rows = (
            np.memmap(base.with_suffix(".rows"), dtype=ROW, mode="r")
            if about.rows
            else np.zeros(0, ROW)
        )
    except (OSError, ValueError):
        return None
    return Columns(rows=rows, names=tuple(about.names), problem=about.problem)


class _About(msgspec.Struct):
    key: list[int]
    rows: int
    names: list[str]
    problem: str = ""


_about = msgspec.json.Decoder(_About)


def _build(tape: Path, base: Path, key: list[int]) -> None:
    found, names = TapeScan(), []
    count = 0
    with whole(base.with_suffix(".rows")) as temporary:
        with temporary.open("wb") as file:
            for block in _rows(tape, found, names):
                file.write(block.tobytes())
                count += len(block)
        base.with_suffix(".json").unlink(missing_ok=True)
    about = _About(key=key, rows=count, names=names, problem=found.problem)
    write_whole(base.with_suffix(".json"), msgspec.json.encode(about))


def _in_memory(tape: Path) -> Columns:
    found, names = TapeScan(), []
    blocks = [block.copy() for block in _rows(tape, found, names)]
    rows = np.concatenate(blocks) if blocks else np.zeros(0, ROW)
    return Columns(rows=rows, names=tuple(names), problem=found.problem)


def _rows(tape: Path, found: TapeScan, names: list[str]) -> Iterator[NDArray[Any]]:
    """Blocks of rows of every whole tick, up to the first damage; a buffer that is reused."""
    index: dict[str, int] = {}
    nobody = [np.nan, np.full((NUM_JOINTS, 3), np.nan), np.zeros(NUM_JOINTS)]

    def number(name: str) -> int:
        if name not in index:
            index[name] = len(names)
            names.append(name[:_NAMED])
        return index[name]

    def stored(row: Any, field: Field) -> Any:
        value = getattr(row, field.name)
        if value is msgspec.UNSET:
            value = field.default()
        if field.keys:  # NaN where one is missing
            return [value.get(key, np.nan) for key in field.keys]
        return number(value or "") if ROW[field.column] == "u1" else value

    buffer, used = np.zeros(_BLOCK, ROW), 0

    def fill(tick: Any, human: Any, fresh: bool, reference: Any, robot: Any) -> None:
        for pose in (reference, robot):
            codec.check_rotation(pose.base_quat)
        parts = {"human": human, "reference": reference, "robot": robot, "tick": tick}
        values: list[Any] = [fresh]
        for stream, fields in _FIELDS.items():
            part = parts[stream]
            values += nobody if part is None else [stored(part, field) for field in fields]
        buffer[used] = tuple(values)

    for _ in codec.read_periods(tape, found, _PARSE, fill):
        used += 1
        if used == _BLOCK:
            yield buffer
            used = 0
    if used:
        yield buffer[:used]


def tick_of(table: Columns, i: int, human: HumanPose | None) -> Tick:
    """Row i as a tick, at i control periods, with the person that is given."""
    row = table.rows[i]

    def value(field: Field) -> Any:
        stored = row[field.column]
        if field.shape is not None:
            return np.asarray(stored, dtype=np.float64)
        if field.keys:
            shares = zip(field.keys, stored.tolist(), strict=True)
            return {key: share for key, share in shares if np.isfinite(share)}
        if ROW[field.column] == "u1":
            return (table.names[stored] if stored < len(table.names) else "unknown") or None
        return stored.item()

    parts = {
        stream: {field.attr: value(field) for field in _FIELDS[stream]}
        for stream in ("reference", "robot", "tick")
    }
    parts["tick"] |= {"index": i, "t": i * a1.CONTROL_DT, "human_fresh": bool(row["fresh"])}
    return Tick(
        human=human,
        reference=ReferencePose(**parts["reference"]),
        robot=RobotState(**parts["robot"]),
        **parts["tick"],
    )
