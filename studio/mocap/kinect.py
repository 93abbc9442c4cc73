"""What Azure Kinect's offline processor writes → human frames: millimetres, microseconds, bodies.

Layout: body-tracking-samples/offline_processor of Microsoft's Azure-Kinect-Samples; some who build
on it add "joint_confidence". Of several bodies, the one seen in most frames is the person.
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from typing import Any

import msgspec

from studio.errors import StudioError
from studio.human.sensor_skeletons import SKELETONS

SKELETON = SKELETONS["k4abt"]
UNIT = 1e-3
"""Metres in its unit."""


class _Body(msgspec.Struct):
    joint_positions: list[tuple[float | None, float | None, float | None]]
    body_id: int = 0
    joint_confidence: list[float | tuple[float]] | None = None


class _Frame(msgspec.Struct):
    timestamp_usec: float
    bodies: list[_Body]


def is_kinect(frame: msgspec.Raw) -> bool:
    """Whether a frame has bodies, as the offline processor's have."""
    try:
        msgspec.json.decode(frame, type=_Frame)
    except msgspec.MsgspecError:
        return False
    return True


def kinect_frames(
    frames: Sequence[msgspec.Raw], joint_names: Sequence[str] | None
) -> Iterator[tuple[str, dict[str, Any] | bytes]]:
    """Human frames (contract.md) with where each is; one that cannot be read as it is.

    joint_names: the order of the joints, where the file says it. Frames that the person is not in
    are gaps. Raises StudioError for other joints than the sensor's.
    """
    order = _order(joint_names)
    read = []
    for raw in frames:
        try:
            read.append(msgspec.json.decode(raw, type=_Frame))
        except msgspec.MsgspecError:
            read.append(bytes(raw))
    bodies = (body.body_id for f in read if isinstance(f, _Frame) for body in f.bodies)
    seen = Counter(bodies).most_common(1)
    for k, frame in enumerate(read):
        if not isinstance(frame, _Frame):
            yield f"frame {k + 1}", frame
            continue
        for body in frame.bodies:
            if body.body_id == seen[0][0]:
                yield f"frame {k + 1}", _frame(frame.timestamp_usec, body, order)


def _frame(timestamp_usec: float, body: _Body, order: Sequence[int]) -> dict[str, Any]:
    whole = len(body.joint_positions) == len(order)
    positions = [
        [None if v is None else UNIT * v for v in body.joint_positions[k]] if whole else None
        for k in (order if whole else range(len(body.joint_positions)))
    ]
    sure = body.joint_confidence
    if sure is not None and len(sure) == len(order):
        flat = [c[0] if isinstance(c, tuple) else c for c in sure]
        sure = [flat[k] for k in order]
    return {
        "t": 1e-6 * timestamp_usec,
        "skeleton": SKELETON.name,
        "positions": positions,
        "confidence": sure,
    }


def _order(joint_names: Sequence[str] | None) -> list[int]:
    """Where each joint of the skeleton stands in the file's order."""
    if not joint_names:
        return list(range(SKELETON.num_joints))
    said = [n.lower().replace("_left", "_l").replace("_right", "_r") for n in joint_names]
    lacks = [joint for joint in SKELETON.joints if joint not in said]
    if lacks or len(said) != SKELETON.num_joints:
        raise StudioError(
            f"joint_names are not those of Azure Kinect: looked for {', '.join(SKELETON.joints)}; "
            f"there is {', '.join(said)[:600]}"
        )
    return [said.index(joint) for joint in SKELETON.joints]
