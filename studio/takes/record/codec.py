"""A Tick to the messages of a tape and back: four streams, JSON, rounded to a micrometre.

Streams: human (only when a new pose came; its publish time is the source's own clock), reference,
robot and tick (every control period, in this order: a period whose tick is missing is torn). What
is in each is said by `tick.FIELDS`.
"""

from collections.abc import Callable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Annotated, Any, TypeVar, get_args, get_origin

import msgspec
import numpy as np

from studio.human.pose import HumanPose
from studio.human.skeleton import JOINTS
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.record.tape import TapeScan, scan
from studio.takes.tick import STREAMS, Field, Tick, fields_in
from studio.takes.untrusted import Seconds, decoded

T = TypeVar("T")

DECIMALS = 6
"""Micrometres and microradians: far below any sensor, and half the size on disk."""
CLOCK_DECIMALS = 9
"""Nanoseconds of a source's or the simulator's clock."""
SHARE_DECIMALS = 4
"""Of votes, and of milliseconds."""
LARGEST = 1e6
"""No length, angle, speed or torque of ours is larger; what is, is damage."""

_Number = Annotated[float, msgspec.Meta(ge=-LARGEST, le=LARGEST)]
_encode = msgspec.json.Encoder().encode
_TITLES = {
    "human": "HumanPose, skeleton studio", "reference": "ReferencePose", "robot": "RobotState",
    "tick": "Tick",
}  # fmt: skip
_TYPES = {"human": HumanPose, "reference": ReferencePose, "robot": RobotState}
_FIELDS = {stream: fields_in("tape", stream) for stream in STREAMS}


def bare(annotation: Any) -> Any:
    """The type without what Annotated says of it: float, bool, dict …"""
    while get_origin(annotation) is Annotated:
        annotation = get_args(annotation)[0]
    return get_origin(annotation) or annotation


def _stored(field: Field) -> Any:
    """What a field may be in JSON."""
    if field.shape is None:
        return Seconds if field.type is float else field.type
    out: Any = _Number
    for size in reversed(field.shape):
        out = Annotated[list[out], msgspec.Meta(min_length=size, max_length=size)]
    return out


def decoder(form: str, stream: str) -> msgspec.json.Decoder[Any]:
    """Reads of a stream's messages what a form holds; UNSET for what came after the take."""
    rows: list[Any] = [("human", bool)] if stream == "tick" else []
    for field in fields_in(form, stream):
        kind = _stored(field)
        optional = (field.name, kind | msgspec.UnsetType, msgspec.UNSET)
        rows.append((field.name, kind) if field.default is None else optional)
    return msgspec.json.Decoder(msgspec.defstruct(f"{stream}_row", rows, kw_only=True))


def parser(form: str, stream: str) -> Callable[[bytes], Any]:
    """`decoder`'s row of a message; ValueError on damage."""
    reads = decoder(form, stream)
    return lambda data: decoded(data, reads)


_parsers = {stream: parser("tape", stream) for stream in STREAMS}


def _schema(stream: str) -> bytes:
    names = {float: "number", bool: "boolean", int: "integer", str: "string", dict: "object"}
    properties: dict[str, Any] = {"human": {"type": "boolean"}} if stream == "tick" else {}
    for field in _FIELDS[stream]:
        kind = names.get(bare(field.type))
        item: dict[str, Any] = {"type": kind} if kind else {}
        if field.shape is not None:
            item = {"type": "number"}
        for size in reversed(field.shape or ()):
            item = {"type": "array", "items": item, "minItems": size, "maxItems": size}
        properties[field.name] = item
    if stream == "human":
        order = "m, z up, x forward, y left; order: " + " ".join(JOINTS)
        properties["positions"]["description"] = order
    return _encode({"type": "object", "title": _TITLES[stream], "properties": properties})


SCHEMAS: dict[str, bytes] = {stream: _schema(stream) for stream in STREAMS}


def _packer(field: Field) -> Callable[[Any], Any]:
    """A value to what JSON holds of it."""
    kind = bare(field.type)
    if field.shape is not None:
        return lambda value: np.round(value, DECIMALS).tolist()
    if kind is dict:
        return lambda value: {
            k: v if isinstance(v, int) else round(float(v), SHARE_DECIMALS)
            for k, v in value.items()
        }
    if kind is float and field.stream != "tick":
        return lambda value: round(float(value), CLOCK_DECIMALS)
    return kind if kind in (bool, int, float) else lambda value: value


_PACKERS = {stream: [(f.attr, f.name, _packer(f)) for f in _FIELDS[stream]] for stream in STREAMS}


def encode(stream: str, value: HumanPose | ReferencePose | RobotState | Tick) -> bytes:
    """A stream's message; of a human pose a frame of docs/contract.md (skeleton "studio")."""
    out: dict[str, Any] = {"skeleton": "studio"} if stream == "human" else {}
    out |= {name: pack(getattr(value, attr)) for attr, name, pack in _PACKERS[stream]}
    if isinstance(value, Tick):
        out["human"] = value.human is not None
    return _encode(out)


def messages(tick: Tick, *, person: bool) -> dict[str, bytes]:
    """A period's messages by stream, in their order; person: the human pose is a new one."""
    parts = {"human": tick.human} if person and tick.human is not None else {}
    parts |= {"reference": tick.reference, "robot": tick.robot, "tick": tick}
    return {stream: encode(stream, value) for stream, value in parts.items()}


def _values(stream: str, row: Any) -> dict[str, Any]:
    out = {}
    for field in _FIELDS[stream]:
        value = getattr(row, field.name)
        if value is not msgspec.UNSET:
            out[field.attr] = value if field.shape is None else np.array(value, dtype=np.float64)
    if "base_quat" in out:
        check_rotation(out["base_quat"])
    return out


def check_rotation(quat: Any) -> None:
    """ValueError unless (4,) is a unit quaternion to 1e-3."""
    if abs(np.linalg.norm(quat) - 1.0) > 1e-3:
        raise ValueError("base_quat is no rotation")


def decode(stream: str, data: bytes) -> Any:
    """The inverse of `encode` of a pose; ValueError on damage."""
    return _TYPES[stream](**_values(stream, _parsers[stream](data)))


def read_periods(
    tape: Path,
    found: TapeScan,
    parse: Mapping[str, Callable[[bytes], Any]],
    make: Callable[[Any, Any, bool, Any, Any], T],
) -> Iterator[T]:
    """What `make` makes of each whole control period, up to the first damage; then look at found.

    parse: of each stream, what of a message is needed; ValueError or OverflowError means damage, in
    `make` too. make(tick, human, fresh, reference, robot): of the parsed messages; human is None
    without a person, fresh is whether their pose came in this period.
    """
    human, fresh = None, False
    parts: dict[str, tuple[int, Any]] = {}
    for message in scan(tape, found):
        topic, number = message.topic, message.sequence
        if topic not in parse:
            continue
        try:
            value = parse[topic](message.data)
            if topic == "human":
                human, fresh = value, True
            elif topic != "tick":
                parts[topic] = number, value
            else:
                if any(parts.get(who, (None,))[0] != number for who in ("reference", "robot")):
                    raise ValueError("its streams do not belong together")
                if not value.human:
                    human, fresh = None, False
                yield make(value, human, fresh, parts["reference"][1], parts["robot"][1])
                fresh = False
        except (ValueError, OverflowError) as error:
            found.complete = False
            found.problem = f"tick {number} is damaged: {error}"
            return


_PARSE = {stream: partial(decode, stream) for stream in _TYPES} | {"tick": _parsers["tick"]}


def read_ticks(tape: Path, found: TapeScan) -> Iterator[tuple[Tick, bool]]:
    """Ticks of a tape, each with whether a new human pose came with it."""

    def make(
        row: Any, human: HumanPose | None, fresh: bool, reference: ReferencePose, robot: RobotState
    ) -> tuple[Tick, bool]:
        values = _values("tick", row)
        return Tick(human=human, reference=reference, robot=robot, **values), fresh

    return read_periods(tape, found, _PARSE, make)
