"""Ticks as JSON for pages and scripts: the field names of Tick, floats rounded to what matters."""

from typing import Any

import msgspec
import numpy as np

from studio.human.pose import HumanPose
from studio.robot.pose import ReferencePose, RobotPose, RobotState
from studio.takes.tick import Tick

DIGITS = 5
"""10 µm and 0.0006°: finer than anything the view or a script can use."""


def numbers(x: Any) -> Any:
    """Nested lists of rounded floats; a value that is not finite becomes null (JSON has none)."""
    array = np.asarray(x, dtype=np.float64)
    rounded = np.round(array, DIGITS)
    if np.isfinite(rounded).all():
        return rounded.tolist()
    return [numbers(row) if np.ndim(row) else _finite(row) for row in rounded]


def _finite(value: float) -> float | None:
    return float(value) if np.isfinite(value) else None


def plain(value: Any) -> Any:
    """Nested dicts and lists with numpy's numbers as Python's, and null for what is not finite."""
    if isinstance(value, dict):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain(item) for item in value]
    if isinstance(value, np.ndarray):
        return numbers(value)
    if isinstance(value, np.generic):
        value = value.item()
    return _finite(value) if isinstance(value, float) else value


def pose_dict(pose: RobotPose) -> dict[str, Any]:
    """base_pos, base_quat, joint_pos, foot_contact, and what a reference or a state adds."""
    out: dict[str, Any] = {
        "base_pos": numbers(pose.base_pos),
        "base_quat": numbers(pose.base_quat),
        "joint_pos": numbers(pose.joint_pos),
        "foot_contact": numbers(pose.foot_contact),
    }
    if isinstance(pose, RobotState | ReferencePose):
        out["base_lin_vel_w"] = numbers(pose.base_lin_vel_w)
    if isinstance(pose, RobotState):
        out["foot_pos_w"] = numbers(pose.foot_pos_w)
        out["trunk_contact"] = bool(pose.trunk_contact)
    return out


def human_dict(pose: HumanPose | None) -> dict[str, Any] | None:
    """The person, as `frames:` files have it (skeleton "studio")."""
    if pose is None:
        return None
    return {
        "t": round(pose.t, 4),
        "skeleton": "studio",
        "positions": numbers(pose.joint_pos_w),
        "confidence": numbers(pose.confidence),
    }


def tick_dict(tick: Tick) -> dict[str, Any]:
    """One control period, as `WS /api/ticks` sends it."""
    return {
        "index": tick.index,
        "t": round(tick.t, 4),
        "mode": tick.mode,
        "state": tick.state,
        "transition_to": tick.transition_to,
        "expert": tick.expert,
        "votes": {name: round(float(v), 3) for name, v in tick.votes.items()},
        "controller": tick.controller,
        "human": human_dict(tick.human),
        "human_fresh": bool(tick.human_fresh),
        "reference": pose_dict(tick.reference),
        "robot": pose_dict(tick.robot),
        "target": numbers(tick.target),
        "clipped": bool(tick.clipped),
        "fallen": bool(tick.fallen),
        "why": tick.why,
        "timings_ms": {k: round(float(v), 4) for k, v in tick.timings_ms.items()},
        "counters": plain(tick.counters),
    }


def tick_json(tick: Tick, **more: Any) -> bytes:
    """UTF-8 JSON of `tick_dict` with further keys."""
    return msgspec.json.encode({**tick_dict(tick), **more})
