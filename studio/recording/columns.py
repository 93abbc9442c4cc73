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
from studio.recording.recorder import TAPE
from studio.recording.tape import TapeScan, scan
from studio.robot import a1

CACHE = ".cache"
VERSION = 1
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


class _Human(msgspec.Struct):
    t: float
    positions: list[list[float]]
    confidence: list[float]


class _Robot(msgspec.Struct):
    base_pos: list[float]
    base_quat: list[float]
    joint_pos: list[float]
    foot_contact: list[float]


class _Tick(msgspec.Struct):
    t: float
    state: str
    expert: str
    human: bool
    fallen: bool


_human, _robot, _tick = (msgspec.json.Decoder(kind) for kind in (_Human, _Robot, _Tick))


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
        about = tape.stat()
    except OSError as error:
        raise StudioError(f"take {folder.name} has no tape: {error.strerror}") from error
    key = [VERSION, about.st_size, about.st_mtime_ns]
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
            if known is not None:
                return known
    return _in_memory(tape)


def _load(base: Path, key: list[int]) -> Columns | None:
    try:
        about = msgspec.json.decode(base.with_suffix(".json").read_bytes(), type=_About)
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
    except (OSError, ValueError, msgspec.MsgspecError):
        return None
    return Columns(rows=rows, names=tuple(about.names), problem=about.problem)


class _About(msgspec.Struct):
    key: list[int]
    rows: int
    names: list[str]
    problem: str = ""


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
                human = _human.decode(message.data)
                pose, fresh = (human.t, human.positions, human.confidence), True
            elif message.topic in ("reference", "robot"):
                r = _robot.decode(message.data)
                value = (r.base_pos, r.base_quat, r.joint_pos, r.foot_contact)
                parts[message.topic] = message.sequence, value
            elif message.topic == "tick":
                tick = _tick.decode(message.data)
                if not tick.human:
                    pose, fresh = None, False
                row = buffer[used]
                seen = pose or (np.nan, np.full((NUM_JOINTS, 3), np.nan), np.zeros(NUM_JOINTS))
                row["t"], row["human_t"] = tick.t, seen[0]
                row["human"], row["confidence"] = seen[1], seen[2]
                row["fresh"], row["fallen"] = fresh, tick.fallen
                for who in ("reference", "robot"):
                    number, value = parts[who]
                    if number != message.sequence:
                        raise ValueError("its streams do not belong together")
                    for key, v in zip(_Robot.__struct_fields__, value, strict=True):
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
        except (ValueError, KeyError, TypeError, OverflowError, msgspec.MsgspecError) as error:
            found.problem = f"tick {message.sequence} is damaged: {error}"
            break
    if used:
        yield buffer[:used]


def _check(row: Any, human: bool) -> None:
    keys = [name for name in ROW.names or () if name.startswith(("reference_", "robot_"))]
    if not all(np.isfinite(row[key]).all() for key in keys):
        raise ValueError("a pose is not finite")
    if human and not (np.isfinite(row["human"]).all() and np.isfinite(row["human_t"])):
        raise ValueError("a human pose is not finite")
