"""Ticks of a drive → the figures of docs/contract.md, each by its definition in studio.metrics."""

from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry, metrics, statistics
from studio.reference.intent import STATES
from studio.reference.stances import NEUTRAL_FEET, tilt_of
from studio.retarget.selector import UNKNOWN
from studio.robot import a1, kinematics
from studio.robot.a1 import CONTROL_DT, FOOT_RADIUS
from studio.takes.as_json import tick_dict
from studio.takes.tick import Tick

Array = NDArray[np.float64]
VOTED = (*STATES, UNKNOWN)
PASSED = (*STATES, "transition")
"""What an expert, and a state, may be called in a tick."""


def trace_line(tick: Tick) -> dict[str, Any]:
    """One line of `--trace`."""
    return tick_dict(tick, "trace", digits=6)


class DriveReport:
    """Keeps what the figures need of each tick (about 1 kB)."""

    def __init__(self) -> None:
        self._ticks: list[Tick] = []

    def add(self, tick: Tick) -> None:
        """One more control period."""
        self._ticks.append(tick)

    def summary(self, expected_seconds: float, rejected_by_source: int = 0) -> dict[str, Any]:
        """The report. expected_seconds: how long it would have been without a fall."""
        ticks = self._ticks
        seconds = len(ticks) * CONTROL_DT
        fell = bool(ticks) and ticks[-1].fallen
        fresh = [tick for tick in ticks if tick.human_fresh]
        rejected = ticks[-1].counters.get("rejected", 0) if ticks else 0
        out: dict[str, Any] = {
            "frames": len(fresh),
            "seconds": round(seconds, 4),
            "survived": not fell,
            "survival_ratio": min(1.0, seconds / expected_seconds) if fell else 1.0,
            "state_seconds": {s: _share(ticks, "state", s) * seconds for s in PASSED},
            "expert_share": {e: _share(fresh, "expert", e) for e in VOTED},
            "rejected_frames": rejected + rejected_by_source,
            "controller": ticks[-1].controller if ticks else None,
        }
        out.update(_physics(ticks) if ticks else _NOTHING)
        return out


def _share(ticks: list[Tick], field: str, value: str) -> float:
    return sum(getattr(t, field) == value for t in ticks) / len(ticks) if ticks else 0.0


def _physics(ticks: list[Tick]) -> dict[str, Any]:
    """What compares the simulated robot with its reference and its limits."""
    robot, ref = [t.robot for t in ticks], [t.reference for t in ticks]
    base, quat = _stack(robot, "base_pos"), _stack(robot, "base_quat")
    joints, contact = _stack(robot, "joint_pos"), _stack(robot, "foot_contact")
    feet = _stack(robot, "foot_pos_w")
    ref_base, ref_quat = _stack(ref, "base_pos"), _stack(ref, "base_quat")
    ref_joints, ref_contact = _stack(ref, "joint_pos"), _stack(ref, "foot_contact")
    ref_feet = kinematics.foot_pos_w(ref_base, ref_quat, ref_joints)
    paws = feet[:, :2, 2] - FOOT_RADIUS
    inference = np.array([t.timings_ms.get("inference", 0.0) for t in ticks])
    return {
        "tilt_deg": _tilt_deg(ticks),
        "base_height_m": _range(base[:, 2]),
        "paw_height_m": {"FR": _range(paws[:, 0]), "FL": _range(paws[:, 1])},
        "max_joint_speed_deg_s": _joint_speed(ticks, ref_joints),
        "clipped_share": float(np.mean([t.clipped for t in ticks])),
        "limit_violations": metrics.limit_violations(
            np.array([t.target for t in ticks]),
            joints,
            _stack(robot, "joint_vel"),
            _stack(robot, "torque"),
            lower=a1.JOINT_LOWER,
            upper=a1.JOINT_UPPER,
            speed_limit=a1.SPEED_LIMIT,
            torque_limit=a1.TORQUE_LIMIT,
        ),
        "joint_rmse_deg": metrics.joint_rmse_deg(joints, ref_joints),
        "orientation_error_deg": metrics.orientation_error_deg(quat, ref_quat),
        "foot_error_m": metrics.foot_error_m(base, quat, feet, ref_base, ref_quat, ref_feet),
        "foot_skate_m_s": metrics.foot_skate_m_s(feet, contact, CONTROL_DT),
        "reference_foot_skate_m_s": metrics.foot_skate_m_s(ref_feet, ref_contact, CONTROL_DT),
        "contact_f1": metrics.contact_f1(contact, ref_contact),
        "distance_m": metrics.distance_m(base),
        "net_distance_m": metrics.net_distance_m(base),
        "heading_change_deg": metrics.heading_change_deg(quat),
        "mean_speed_m_s": metrics.mean_speed_m_s(base, CONTROL_DT),
        "inference_ms": {**statistics.percentiles(inference), "max": float(inference.max())},
    }


_NOTHING: dict[str, Any] = {
    "tilt_deg": {axis: [0.0, 0.0] for axis in ("roll", "pitch", "yaw")},
    "base_height_m": [0.0, 0.0],
    "paw_height_m": {"FR": [0.0, 0.0], "FL": [0.0, 0.0]},
    "max_joint_speed_deg_s": {state: 0.0 for state in PASSED},
    "clipped_share": 0.0,
    "limit_violations": 0,
    "joint_rmse_deg": 0.0,
    "orientation_error_deg": 0.0,
    "foot_error_m": 0.0,
    "foot_skate_m_s": 0.0,
    "reference_foot_skate_m_s": 0.0,
    "contact_f1": 1.0,
    "distance_m": 0.0,
    "net_distance_m": 0.0,
    "heading_change_deg": 0.0,
    "mean_speed_m_s": 0.0,
    "inference_ms": {"p50": 0.0, "p95": 0.0, "p99": 0.0, "max": 0.0},
}
"""The figures of a source without a single control period."""


def _stack(poses: list[Any], name: str) -> Array:
    return np.array([getattr(pose, name) for pose in poses])


def _range(x: Array) -> list[float]:
    return [float(np.min(x)), float(np.max(x))]


def _joint_speed(ticks: list[Tick], joints: Array) -> dict[str, float]:
    """Fastest joint of the reference in each state, degrees a second."""
    speed = metrics.joint_speed_deg_s(joints, CONTROL_DT)
    state = np.array([t.state for t in ticks])[1:]
    # Placing the robot in the first voted state is no motion.
    moved = np.array([b.robot.t > a.robot.t for a, b in pairwise(ticks)], dtype=bool)
    return {s: float(np.max(speed[(state == s) & moved], initial=0.0)) for s in PASSED}


def _tilt_deg(ticks: list[Tick]) -> dict[str, list[float]]:
    """Range of the simulated trunk's tilt about its state's neutral pose, outside transitions.

    Yaw is the trunk's turn against its standing feet: where the robot has walked to, and which
    way it faces there, is no tilt.
    """
    return tilt_ranges(
        [
            tilt_against_feet(t, t.robot.base_quat, t.robot.foot_pos_w)
            for t in ticks
            if t.state != "transition"
        ]
    )


def tilt_ranges(tilt: list[Array]) -> dict[str, list[float]]:
    """Least and largest roll, pitch and yaw, degrees, of (3,) rad each; 0 of none."""
    rows = np.degrees(np.array(tilt)) if tilt else np.zeros((1, 3))
    return {axis: _range(rows[:, i]) for i, axis in enumerate(("roll", "pitch", "yaw"))}


def tilt_against_feet(tick: Tick, base_quat: Array, foot_pos_w: Array) -> Array:
    """(3,) rad roll, pitch, yaw about the neutral of the tick's state, of a trunk (4,) on feet
    (4, 3): its robot's, or its reference's."""
    state = tick.state
    legs = np.flatnonzero(tick.reference.foot_contact > 0.5)
    if state == "sit" or len(legs) < 2:
        legs = np.array([2, 3])
    now, rest = foot_pos_w[legs, :2], NEUTRAL_FEET[state][legs, :2]  # type: ignore[index]
    a, b = rest - rest.mean(axis=0), now - now.mean(axis=0)
    yaw = np.arctan2(np.sum(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]), np.sum(a * b))
    turned_back = geometry.quat_from_yaw(-yaw)
    return tilt_of(state, geometry.quat_mul(turned_back, base_quat))  # type: ignore[arg-type]
