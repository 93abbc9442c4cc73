"""A human frame as it was sent → its numbers, or FrameRejected saying what a frame looks like."""

import math
import re
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.sensor_skeletons import SourceSkeleton

Array = NDArray[np.float64]

MAX_BYTES = 65_536
"""A frame of 33 joints takes some 2 kB."""
_SHAPE = '{"t": seconds, "skeleton": NAME, "positions": [[x, y, z], …] in m, "confidence": [c, …]}'


class FrameRejected(StudioError):
    """A frame that does not fit; the message says what is wrong and what would fit."""


class Frame(msgspec.Struct):
    """As in contract.md."""

    t: float
    skeleton: str
    positions: list[tuple[float | None, float | None, float | None] | None]
    confidence: list[float | None] | None = None


_DECODER = msgspec.json.Decoder(Frame)
_NAN = re.compile(r"(?<![\w\"])-?NaN\b")
_NAN_BYTES = re.compile(_NAN.pattern.encode())
_UNFIT = (
    msgspec.MsgspecError, ValueError, TypeError, OverflowError, RecursionError, MemoryError,
    KeyError, AttributeError,
)  # fmt: skip


def parse_frame(raw: object) -> Frame:
    """JSON text or bytes, or the decoded object, as a frame; FrameRejected for anything else."""
    if isinstance(raw, (str, bytes, bytearray, memoryview)):
        size = len(raw)
        if size > MAX_BYTES:
            raise FrameRejected(f"a frame of {size} bytes; at most {MAX_BYTES} are read")
    elif not isinstance(raw, dict):
        raise FrameRejected(f"a frame is a JSON object {_SHAPE}, not {type(raw).__name__}")
    try:
        if isinstance(raw, dict):
            return msgspec.convert(raw, Frame)
        return _DECODER.decode(_without_nan(raw))
    except _UNFIT as e:
        why = " ".join(str(e).split())[:160] or type(e).__name__
        raise FrameRejected(f"{why}; a frame is {_SHAPE}") from None


def _without_nan(raw: Any) -> Any:
    """JSON has no word for NaN, and Python writes one all the same: it means the same as null."""
    if isinstance(raw, str):
        return _NAN.sub("null", raw) if "NaN" in raw else raw
    return _NAN_BYTES.sub(b"null", raw) if b"NaN" in bytes(raw) else raw


def arrays_of(frame: Frame, skeleton: SourceSkeleton) -> tuple[Array, Array | None]:
    """Positions (n, 3) and confidence (n,) or None, right in number.

    A joint without a place (null, or three of null or NaN) is not seen: it is put where another
    is, confidence 0. One of which only a part is missing is damaged, and left so.
    """
    n = skeleton.num_joints
    for what, values in (("positions", frame.positions), ("confidences", frame.confidence)):
        if values is not None and len(values) != n:
            raise FrameRejected(f"{len(values)} {what}; skeleton {skeleton.name} has {n} joints")
    positions = np.array([p or (math.nan,) * 3 for p in frame.positions], dtype=np.float64)
    confidence = None
    if frame.confidence is not None:
        confidence = np.array(frame.confidence, dtype=np.float64)
        confidence[np.isnan(confidence)] = 0.0
    unseen = np.isnan(positions).all(axis=1)
    if unseen.all():
        raise FrameRejected("no joint has a place; where nobody is seen, send nothing")
    if unseen.any():
        if confidence is None:
            confidence = np.full(n, skeleton.full_confidence)
        confidence[unseen] = 0.0
        positions[unseen] = positions[~unseen][0]
    return positions, confidence
