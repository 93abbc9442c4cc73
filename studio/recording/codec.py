"""A Tick to the messages of a tape and back: four streams, JSON, rounded to a micrometre.

Streams: human (only when a new pose came; its publish time is the source's own clock), reference,
robot and tick (every control period, in this order: a period whose tick is missing is torn).
"""

from typing import Any

import msgspec
import numpy as np

from studio.human.pose import HumanPose
from studio.human.skeleton import JOINTS, NUM_JOINTS
from studio.recording.tick import Tick
from studio.robot.pose import ReferencePose, RobotState

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

_encode = msgspec.json.Encoder().encode
_decode = msgspec.json.Decoder().decode


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


def _arrays(row: dict[str, Any], shapes: dict[str, tuple[int, ...]]) -> dict[str, Any]:
    out = {}
    for key, shape in shapes.items():
        value = np.array(row[key], dtype=np.float64)
        if value.shape != shape or not np.isfinite(value).all():
            raise ValueError(f"{key} is not {shape} finite numbers")
        out[key] = value
    return out


def _object_of(data: bytes) -> dict[str, Any]:
    row = _decode(data)
    if not isinstance(row, dict):
        raise ValueError("a message is not an object")
    return row


def decode_human(data: bytes) -> HumanPose:
    """The inverse of `encode_human`; ValueError, KeyError or msgspec's error on damage."""
    row = _object_of(data)
    shapes = {"positions": (NUM_JOINTS, 3), "confidence": (NUM_JOINTS,)}
    arrays = _arrays(row, shapes)
    return HumanPose(
        t=float(row["t"]), joint_pos_w=arrays["positions"], confidence=arrays["confidence"]
    )


def decode_reference(data: bytes) -> ReferencePose:
    """The inverse of `encode_reference`."""
    return ReferencePose(**_arrays(_object_of(data), REFERENCE_SHAPES))


def decode_robot(data: bytes) -> RobotState:
    """The inverse of `encode_robot`."""
    row = _object_of(data)
    return RobotState(
        t=float(row["t"]),
        trunk_contact=bool(row["trunk_contact"]),
        self_collision=bool(row["self_collision"]),
        **_arrays(row, ROBOT_SHAPES),
    )


def decode_tick(
    data: bytes, human: HumanPose | None, reference: ReferencePose, robot: RobotState
) -> Tick:
    """The inverse of `encode_tick`, given the other streams' values of the same period."""
    row = _object_of(data)
    plain = {key: row[key] for key in _TICK_PLAIN}
    human = human if row["human"] else None
    return Tick(
        human=human, reference=reference, robot=robot, **plain, **_arrays(row, _TICK_ARRAYS)
    )
