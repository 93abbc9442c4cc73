"""A Tick to the messages of a tape and back: four streams, JSON, rounded to a micrometre.

Streams: human (only when a new pose came; its publish time is the source's own clock), reference,
robot and tick (every control period, in this order: a period whose tick is missing is torn).
"""

from typing import Any

import msgspec
import numpy as np

from studio.human.pose import HumanPose
from studio.human.skeleton import JOINTS, NUM_JOINTS
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.stored import Count, Line, Name, Seconds, decoded
from studio.takes.tick import Tick

DECIMALS = 6
"""Micrometres and microradians: far below any sensor, and half the size on disk."""

REFERENCE_SHAPES = {
    "base_pos": (3,), "base_quat": (4,), "joint_pos": (12,), "foot_contact": (4,),
    "base_lin_vel_w": (3,), "base_ang_vel_b": (3,), "joint_vel": (12,),
}  # fmt: skip
ROBOT_SHAPES = REFERENCE_SHAPES | {"foot_pos_w": (4, 3), "torque": (12,)}
_TICK_ARRAYS = {"action": (12,), "target": (12,)}
_TICK_PLAIN = (
    "index", "t", "human_fresh", "expert", "votes", "state", "transition_to", "mode",
    "controller", "clipped", "fallen", "why", "timings_ms", "counters",
)  # fmt: skip

LARGEST = 1e6
"""No length, angle, speed or torque of ours is larger; what is, is damage."""

_encode = msgspec.json.Encoder().encode


class HumanRow(msgspec.Struct):
    """The human stream's message, its numbers not yet counted."""

    t: Seconds
    positions: list[list[float]]
    confidence: list[float]


class ReferenceRow(msgspec.Struct):
    """The reference stream's."""

    base_pos: list[float]
    base_quat: list[float]
    joint_pos: list[float]
    foot_contact: list[float]
    base_lin_vel_w: list[float]
    base_ang_vel_b: list[float]
    joint_vel: list[float]


class RobotRow(ReferenceRow):
    """The robot stream's."""

    t: Seconds
    foot_pos_w: list[list[float]]
    torque: list[float]
    trunk_contact: bool
    self_collision: bool


class TickRow(msgspec.Struct):
    """The tick stream's."""

    index: Count
    t: Seconds
    human_fresh: bool
    expert: Name
    votes: dict[Name, float]
    state: Name
    transition_to: Name | None
    mode: Name
    controller: Name
    clipped: bool
    fallen: bool
    why: Line
    timings_ms: dict[Name, float]
    counters: dict[Name, Count]
    human: bool
    action: list[float]
    target: list[float]


_human = msgspec.json.Decoder(HumanRow)
_reference = msgspec.json.Decoder(ReferenceRow)
_robot = msgspec.json.Decoder(RobotRow)
_tick = msgspec.json.Decoder(TickRow)


def _array_schema(shape: tuple[int, ...], text: str = "") -> dict[str, Any]:
    item: dict[str, Any] = {"type": "number"}
    for size in reversed(shape):
        item = {"type": "array", "items": item, "minItems": size, "maxItems": size}
    return item | ({"description": text} if text else {})


def _object(properties: dict[str, Any], title: str) -> bytes:
    return _encode({"type": "object", "title": title, "properties": properties})


def _schemas() -> dict[str, bytes]:
    number, text, flag = {"type": "number"}, {"type": "string"}, {"type": "boolean"}
    plain: dict[str, Any] = dict.fromkeys(_TICK_PLAIN, text)
    plain |= {"index": {"type": "integer"}, "t": number, "transition_to": {}}
    plain |= dict.fromkeys(("human", "human_fresh", "clipped", "fallen"), flag)
    plain |= {key: {"type": "object"} for key in ("votes", "timings_ms", "counters")}
    arrays = {k: _array_schema(v) for k, v in _TICK_ARRAYS.items()}
    joints = "m, z up, x forward, y left; order: " + " ".join(JOINTS)
    human = {
        "t": number,
        "positions": _array_schema((NUM_JOINTS, 3), joints),
        "confidence": _array_schema((NUM_JOINTS,)),
    }
    robot = {k: _array_schema(v) for k, v in ROBOT_SHAPES.items()}
    return {
        "human": _object(human, "HumanPose, skeleton studio"),
        "reference": _object(
            {k: _array_schema(v) for k, v in REFERENCE_SHAPES.items()}, "ReferencePose"
        ),
        "robot": _object(
            {"t": number, **robot, "trunk_contact": flag, "self_collision": flag}, "RobotState"
        ),
        "tick": _object(plain | arrays, "Tick"),
    }


SCHEMAS: dict[str, bytes] = _schemas()


def _plain(value: np.ndarray) -> list:
    return np.round(value, DECIMALS).tolist()


def encode_human(pose: HumanPose) -> bytes:
    """A human pose as a frame of contract.md (skeleton "studio")."""
    return _encode(
        {
            "t": round(pose.t, 9),
            "skeleton": "studio",
            "positions": _plain(pose.joint_pos_w),
            "confidence": _plain(pose.confidence),
        }
    )


def encode_reference(pose: ReferencePose) -> bytes:
    """The reference stream's message."""
    return _encode({key: _plain(getattr(pose, key)) for key in REFERENCE_SHAPES})


def encode_robot(state: RobotState) -> bytes:
    """The robot stream's message."""
    out: dict[str, Any] = {key: _plain(getattr(state, key)) for key in ROBOT_SHAPES}
    out["t"] = round(state.t, 9)
    out["trunk_contact"] = bool(state.trunk_contact)
    out["self_collision"] = bool(state.self_collision)
    return _encode(out)


def encode_tick(tick: Tick) -> bytes:
    """The tick stream's message: all of a tick that is in no other stream."""
    out = {key: getattr(tick, key) for key in _TICK_PLAIN}
    out["votes"] = {k: round(float(v), 4) for k, v in tick.votes.items()}
    out["timings_ms"] = {k: round(float(v), 4) for k, v in tick.timings_ms.items()}
    out["human_fresh"], out["clipped"] = bool(tick.human_fresh), bool(tick.clipped)
    out["fallen"] = bool(tick.fallen)
    out["human"] = tick.human is not None
    return _encode(out | {key: _plain(getattr(tick, key)) for key in _TICK_ARRAYS})


def array(key: str, value: object, shape: tuple[int, ...]) -> np.ndarray:
    """A row's numbers as an array of that shape; ValueError for another one, or for damage."""
    out = np.array(value, dtype=np.float64)
    if out.shape != shape or not (np.abs(out) <= LARGEST).all():
        raise ValueError(f"{key} is not {shape} numbers of a plausible size")
    if key == "base_quat" and abs(np.linalg.norm(out) - 1.0) > 1e-3:
        raise ValueError(f"{key} is no rotation")
    return out


def _arrays(row: object, shapes: dict[str, tuple[int, ...]]) -> dict[str, Any]:
    return {key: array(key, getattr(row, key), shape) for key, shape in shapes.items()}


def decode_human(data: bytes) -> HumanPose:
    """The inverse of `encode_human`; ValueError on damage, as all of these."""
    row = decoded(data, _human)
    return HumanPose(
        t=row.t,
        joint_pos_w=array("positions", row.positions, (NUM_JOINTS, 3)),
        confidence=array("confidence", row.confidence, (NUM_JOINTS,)),
    )


def decode_reference(data: bytes) -> ReferencePose:
    """The inverse of `encode_reference`."""
    return ReferencePose(**_arrays(decoded(data, _reference), REFERENCE_SHAPES))


def decode_robot(data: bytes) -> RobotState:
    """The inverse of `encode_robot`."""
    row = decoded(data, _robot)
    return RobotState(
        t=row.t,
        trunk_contact=row.trunk_contact,
        self_collision=row.self_collision,
        **_arrays(row, ROBOT_SHAPES),
    )


def decode_tick(
    data: bytes, human: HumanPose | None, reference: ReferencePose, robot: RobotState
) -> Tick:
    """The inverse of `encode_tick`, given the other streams' values of the same period."""
    row = decoded(data, _tick)
    plain = {key: getattr(row, key) for key in _TICK_PLAIN}
    human = human if row.human else None
    return Tick(
        human=human, reference=reference, robot=robot, **plain, **_arrays(row, _TICK_ARRAYS)
    )
