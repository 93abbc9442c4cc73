"""A file of human frames → HumanClip: a JSON object a line (docs/contract.md), or one document.

A document is an array of such frames, an object with `frames`, or what Azure Kinect's offline
processor writes.
"""

import io
import logging
from collections.abc import Iterable, Iterator
from itertools import chain, islice
from pathlib import Path
from typing import Any, BinaryIO

import msgspec
import numpy as np

from studio.errors import StudioError
from studio.files import open_regular
from studio.human.pose import HumanClip, HumanPose
from studio.human.posture import SEEN
from studio.human.sensor_skeletons import SKELETONS
from studio.mocap.gate import FrameGate
from studio.mocap.kinect import UNIT, is_kinect, kinect_frames
from studio.mocap.raw_frame import MAX_BYTES, FrameRejected
from studio.mocap.recorded import Recorded, settled
from studio.mocap.source_report import Refused, report_on
from studio.mocap.text import MAX_FRAMES, encoding_of

log = logging.getLogger(__name__)

MAX_FILE = 2 * 2**30
"""Bytes of a file with a frame a line, which is read line by line."""
MAX_DOCUMENT = 256 * 2**20
"""Bytes of a document, which is read whole."""
_UNITS = ((1.0, "seconds"), (1e-3, "milliseconds"), (1e-6, "microseconds"), (1e-9, "nanoseconds"))
_PERIOD = 1 / 500, 1 / 4
"""s between the frames of any sensor: by this the unit of their times is told."""
_SNIFFED = 200
_NO_JSON = (msgspec.MsgspecError, UnicodeDecodeError, RecursionError)
_Found = Iterator[tuple[str, Any]]
"""Frames as they stand in the file, each with where."""


class _Stamp(msgspec.Struct):
    t: float


class _Document(msgspec.Struct):
    frames: list[msgspec.Raw]
    joint_names: list[str] | None = None


def load_frames(path: str | Path) -> tuple[HumanClip, int]:
    """The clip in a file of frames, and how many frames were refused; see `read_frames`."""
    recorded = read_frames(path)
    return recorded.clip, recorded.report.refused.frames


def read_frames(path: str | Path) -> Recorded:
    """The clip in a file of frames and the report on it.

    A frame that does not fit is refused, counted and logged (the first few), and the rest read on.
    Times that can be no seconds are read as the milli-, micro- or nanoseconds they must be, and
    the report says so. A joint never seen is reported as missing. Raises StudioError when the file
    cannot be read or holds no good frame, with the first reason.
    """
    path = Path(path)
    with open_regular(path, MAX_FILE) as file:
        try:
            return _read(path, *_found(file))
        except OSError as error:
            raise StudioError(f"cannot read {path}: {error}; give human frames") from error


def _read(path: Path, found: _Found, scale_m: float) -> Recorded:
    start = list(islice(found, _SNIFFED))
    unit, unit_name = _time_unit([raw for _, raw in start])
    gate = FrameGate(live=False, time_unit=unit)
    poses: list[HumanPose] = []
    refused = Refused()
    for where, raw in chain(start, found):
        try:
            poses.append(gate.check(raw))
        except FrameRejected as e:
            refused = refused.plus(f"{where}: {e}")
            if gate.rejected <= 5:
                log.warning("%s, %s: %s", path.name, where, e)
        if len(poses) > MAX_FRAMES:
            raise StudioError(f"{path.name}: more than {MAX_FRAMES} frames")
    if not poses:
        first = refused.why[0] if refused.why else "it is empty"
        raise StudioError(f"{path.name} holds no good frame; {first}")
    clip = HumanClip(
        name=path.stem,
        t=np.array([pose.t for pose in poses]),
        joint_pos_w=np.stack([pose.joint_pos_w for pose in poses]),
        confidence=np.stack([pose.confidence for pose in poses]),
    )
    notes = () if unit == 1.0 else (f"t is in {unit_name}: read as such",)
    seen = clip.confidence.max(axis=0) >= SEEN
    skeleton = gate.skeleton or SKELETONS["studio"]
    report = report_on(skeleton, seen=seen, scale_m=scale_m, refused=refused, notes=notes)
    return settled(clip, report)


def _time_unit(raws: Iterable[Any]) -> tuple[float, str]:
    """Seconds in the unit of the frames' times, and its name: seconds unless they cannot be."""
    stamps: list[float] = []
    for raw in raws:
        try:
            stamp = raw["t"] if isinstance(raw, dict) else msgspec.json.decode(raw, type=_Stamp).t
        except _NO_JSON:
            continue
        stamps.append(float(stamp))
    steps = np.diff(stamps)
    steps = np.sort(steps[steps > 0.0])
    period = float(steps[len(steps) // 4]) if len(steps) else 0.0  # pauses are the longer ones
    shortest, longest = _PERIOD
    fitting = (unit for unit in _UNITS if shortest <= period * unit[0] <= longest)
    return next(fitting, _UNITS[0])


def _found(file: BinaryIO) -> tuple[_Found, float]:
    """The frames in a file, whichever way it holds them, and the metres in its unit.

    By lines unless the first is no frame.
    """
    if encoding_of(file.peek(4096)[:4096]).startswith("utf-16"):  # type: ignore[attr-defined]
        text = io.TextIOWrapper(file, "utf-16", errors="replace").read(MAX_DOCUMENT)
        file = io.BufferedReader(io.BytesIO(text.encode()))  # type: ignore[arg-type]
    first = file.readline(MAX_BYTES + 2).removeprefix(b"\xef\xbb\xbf")
    try:
        msgspec.json.decode(first, type=_Stamp)
    except _NO_JSON:
        first += file.read(MAX_DOCUMENT)
        document = None if file.peek(1) else _document(first)  # type: ignore[attr-defined]
        if document is not None:
            return document
    return _lines(chain(_split(io.BytesIO(first)), _split(file))), 1.0


def _document(data: bytes) -> tuple[_Found, float] | None:
    """The frames of a JSON document, and the metres in its unit; None where it is none."""
    try:
        document = msgspec.json.decode(data, type=list[msgspec.Raw] | _Document)
    except _NO_JSON:
        return None
    frames = document if isinstance(document, list) else document.frames
    if any(is_kinect(frame) for frame in frames[:_SNIFFED]):
        names = document.joint_names if isinstance(document, _Document) else None
        return kinect_frames(frames, names), UNIT
    return ((f"frame {k + 1}", bytes(frame)) for k, frame in enumerate(frames)), 1.0


def _split(file: BinaryIO) -> Iterator[bytes]:
    """Lines of bounded length: a file without line ends must not fill the memory."""
    return iter(lambda: file.readline(MAX_BYTES + 2), b"")


def _lines(lines: Iterable[bytes]) -> _Found:
    return ((f"line {k + 1}", line) for k, line in enumerate(lines) if line.strip())
