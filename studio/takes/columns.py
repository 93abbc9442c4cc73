"""A tape's streams as one table on disk, a row per tick: built once, then read by window.

The tape stays the truth; the table is a cache beside the library (`.cache/NAME.*`), rebuilt when
the tape changes. An hour is about 70 MB of it and is never read whole: numpy maps the file, and
whoever needs all of it goes through it in blocks.
"""

import contextlib
import os
import threading
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.skeleton import NUM_JOINTS
from studio.robot import a1
from studio.takes.record.codec import LARGEST, HumanRow
from studio.takes.record.recorder import TAPE
from studio.takes.record.tape import TapeScan, scan
from studio.takes.stored import Name, Seconds, decoded, read_json

CACHE = ".cache"
VERSION = 2
ROW = np.dtype(
    [
        ("t", "f8"),  # s into the source
        ("human_t", "f8"),  # s, the source's own clock; NaN before the first pose
        ("fresh", "?"),  # a new pose came with this tick
        ("fallen", "?"),
        ("state", "u1"),  # indices into Columns.names
        ("expert", "u1"),
        ("human", "f4", (NUM_JOINTS, 3)),
        ("confidence", "f4", (NUM_JOINTS,)),
        *(
            (f"{who}_{key}", "f4", shape)
            for who in ("reference", "robot")
            for key, shape in (
                ("base_pos", (3,)), ("base_quat", (4,)), ("joint_pos", (12,)),
                ("foot_contact", (4,)),
            )
        ),
    ]
)  # fmt: skip
_BLOCK = 1024
_building = threading.Lock()


class _Pose(msgspec.Struct):
    base_pos: list[float]
    base_quat: list[float]
    joint_pos: list[float]
    foot_contact: list[float]


class _Tick(msgspec.Struct):
    t: Seconds
    state: Name
    expert: Name
    human: bool
    fallen: bool


_human = msgspec.json.Decoder(HumanRow)
_pose = msgspec.json.Decoder(_Pose)
_tick = msgspec.json.Decoder(_Tick)


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
    temporary = base.with_suffix(f".{os.getpid()}.tmp")
    try:
        count = 0
        with temporary.open("wb") as file:
            for block in _rows(tape, found, names):
                file.write(block.tobytes())
                count += len(block)
        about = _About(key=key, rows=count, names=names, problem=found.problem)
        base.with_suffix(".json").unlink(missing_ok=True)
        temporary.replace(base.with_suffix(".rows"))
        base.with_suffix(".json").write_bytes(msgspec.json.encode(about))
    finally:
        temporary.unlink(missing_ok=True)


def _in_memory(tape: Path) -> Columns:
    found, names = TapeScan(), []
    blocks = [block.copy() for block in _rows(tape, found, names)]
    rows = np.concatenate(blocks) if blocks else np.zeros(0, ROW)
    return Columns(rows=rows, names=tuple(names), problem=found.problem)


def _rows(tape: Path, found: TapeScan, names: list[str]) -> Iterator[NDArray[Any]]:
    """Blocks of rows of every whole tick, up to the first damage; a buffer that is reused."""
    buffer, used = np.zeros(_BLOCK, ROW), 0
    pose: tuple | None = None
    fresh = False
    parts: dict[str, tuple[int, tuple]] = {}
    index: dict[str, int] = {}
    for message in scan(tape, found):
        try:
            if message.topic == "human":
                human = decoded(message.data, _human)
                pose, fresh = (human.t, human.positions, human.confidence), True
            elif message.topic in ("reference", "robot"):
                r = decoded(message.data, _pose)
                value = (r.base_pos, r.base_quat, r.joint_pos, r.foot_contact)
                parts[message.topic] = message.sequence, value
            elif message.topic == "tick":
                tick = decoded(message.data, _tick)
                if not tick.human:
                    pose, fresh = None, False
                row = buffer[used]
                seen = pose or (np.nan, np.full((NUM_JOINTS, 3), np.nan), np.zeros(NUM_JOINTS))
                row["t"], row["human_t"] = tick.t, seen[0]
                row["fresh"], row["fallen"] = fresh, tick.fallen
                with np.errstate(over="ignore"):  # float32's infinity is found below
                    row["human"], row["confidence"] = seen[1], seen[2]
                    for who in ("reference", "robot"):
                        number, value = parts[who]
                        if number != message.sequence:
                            raise ValueError("its streams do not belong together")
                        for key, v in zip(_Pose.__struct_fields__, value, strict=True):
                            row[f"{who}_{key}"] = v
                for key, name in (("state", tick.state), ("expert", tick.expert)):
                    if name not in index:
                        index[name] = len(names)
                        names.append(name[:40])
                    row[key] = index[name]
                _check(row, pose is not None)
                fresh, used = False, used + 1
                if used == _BLOCK:
                    yield buffer
                    used = 0
        except (ValueError, KeyError, OverflowError) as error:
            found.problem = f"tick {message.sequence} is damaged: {error}"
            break
    if used:
        yield buffer[:used]


def _check(row: Any, human: bool) -> None:
    """ValueError unless everything in it is finite and of a plausible size."""
    for who in ("reference", "robot"):
        if not all(
            (np.abs(row[f"{who}_{key}"]) <= LARGEST).all() for key in _Pose.__struct_fields__
        ):
            raise ValueError("a pose is of no plausible size")
        if abs(np.linalg.norm(row[f"{who}_base_quat"]) - 1.0) > 1e-3:
            raise ValueError("base_quat is no rotation")
    if human and not (np.abs(row["human"]) <= LARGEST).all():
        raise ValueError("a human pose is of no plausible size")
