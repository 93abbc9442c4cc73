"""Reference poses that were recorded to a map of what a data set covers, and what to record next.

Each state has the ranges its tasks span; each range is cut into bins; a bin is covered by
ENOUGH frames. The thinnest bin names the task that would fill it.
"""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference.intent import STATES
from studio.robot import kinematics

Array = NDArray[np.float64]

ENOUGH = 45
"""Frames (1.5 s) in a bin that count as covered: what one unhurried key pose leaves behind."""


@dataclass(frozen=True, kw_only=True)
class Axis:
    """One range of a state: edges of its bins and the task whose motion fills it."""

    name: str
    unit: str
    edges: tuple[float, ...]
    task: str


def _edges(low: float, high: float, bins: int) -> tuple[float, ...]:
    return tuple(np.linspace(low, high, bins + 1).round(6).tolist())


AXES: dict[str, tuple[Axis, ...]] = {
    "stand": (
        Axis(name="roll", unit="deg", edges=_edges(-40, 40, 8), task="tilt"),
        Axis(name="pitch", unit="deg", edges=_edges(-40, 40, 8), task="tilt"),
        Axis(name="yaw", unit="deg", edges=_edges(-40, 40, 8), task="tilt"),
        Axis(name="height", unit="m", edges=_edges(0.18, 0.28, 5), task="crouch"),
        Axis(name="right paw", unit="m", edges=_edges(0.0, 0.4, 5), task="manipulate_right"),
        Axis(name="left paw", unit="m", edges=_edges(0.0, 0.4, 5), task="manipulate_left"),
    ),
    "walk": (
        Axis(name="speed", unit="m/s", edges=_edges(0.0, 1.0, 5), task="forward"),
        Axis(name="turn", unit="deg/s", edges=_edges(-15, 15, 6), task="turn"),
    ),
    "sit": (
        Axis(name="roll", unit="deg", edges=_edges(-7.5, 7.5, 4), task="sit_tilt"),
        Axis(name="pitch", unit="deg", edges=_edges(-85, -55, 4), task="sit_tilt"),
        Axis(name="right paw", unit="m", edges=_edges(0.3, 0.9, 5), task="sit_manipulate"),
        Axis(name="left paw", unit="m", edges=_edges(0.3, 0.9, 5), task="sit_manipulate"),
    ),
}


@dataclass(frozen=True, kw_only=True)
class Coverage:
    """counts[state][axis]: frames per bin; seconds[state]; proposals: tasks, the most wanted first,
    each with the reason."""

    counts: dict[str, dict[str, NDArray[np.int64]]]
    seconds: dict[str, float]
    proposals: tuple[tuple[str, str], ...]

    def share(self, state: str) -> float:
        """Share of a state's bins that hold ENOUGH frames, [0, 1]."""
        bins = np.concatenate(list(self.counts[state].values()))
        return float(np.mean(bins >= ENOUGH))


def values(
    state: str, base_pos: Array, base_quat: Array, joint_pos: Array, dt: float
) -> dict[str, Array]:
    """Each axis' value per frame, in the axis' own unit, of poses (T, 3), (T, 4), (T, 12).

    Yaw is taken about the take's median heading.
    """
    yaw = np.unwrap(geometry.heading(base_quat)) if len(base_quat) else np.zeros(0)
    roll, pitch, _ = np.rad2deg(geometry.quat_to_rpy(base_quat)).T
    foot = kinematics.foot_pos_w(base_pos, base_quat, joint_pos)
    ones = np.ones(max(1, round(1.0 / dt))) * dt
    # Over one second: within a stride the trunk speeds up and slows down.
    path = np.linalg.norm(np.diff(base_pos[:, :2], axis=0, prepend=base_pos[:1, :2]), axis=-1) / dt
    turn = np.diff(np.rad2deg(yaw), prepend=np.rad2deg(yaw[:1])) / dt
    found: dict[str, NDArray] = {
        "roll": roll,
        "pitch": pitch,
        "yaw": np.rad2deg(yaw - np.median(yaw)) if len(yaw) else yaw,
        "height": base_pos[:, 2],
        "right paw": foot[:, 0, 2],
        "left paw": foot[:, 1, 2],
        "speed": np.convolve(path, ones, "same"),
        "turn": np.convolve(turn, ones, "same"),
    }
    return {name: np.asarray(value, dtype=np.float64) for name, value in found.items()}


def coverage(segments: Mapping[str, list[dict[str, Array]]], dt: float) -> Coverage:
    """The map of segments[state] = list of `values(...)`; states without data count as empty."""
    counts: dict[str, dict[str, NDArray[np.int64]]] = {}
    seconds: dict[str, float] = {}
    for state in STATES:
        parts = segments.get(state, [])
        seconds[state] = dt * sum(len(p["roll"]) for p in parts)
        counts[state] = {}
        for axis in AXES[state]:
            data = np.concatenate([p[axis.name] for p in parts]) if parts else np.zeros(0)
            inside = np.clip(data, axis.edges[0], axis.edges[-1])
            counts[state][axis.name] = np.histogram(inside, axis.edges)[0].astype(np.int64)
    return Coverage(counts=counts, seconds=seconds, proposals=_proposals(counts))


def _proposals(
    counts: dict[str, dict[str, NDArray[np.int64]]],
) -> tuple[tuple[str, str], ...]:
    """Tasks by the share of their bins that are thin; one reason each, naming the thinnest bin."""
    ranked = []
    for state, axes in counts.items():
        for axis in AXES[state]:
            bins = axes[axis.name]
            thin = float(np.mean(np.minimum(bins / ENOUGH, 1.0)))
            worst = int(np.argmin(bins))
            low, high = axis.edges[worst], axis.edges[worst + 1]
            reason = (
                f"{state}: {axis.name} {low:g} to {high:g} {axis.unit} has {bins[worst]} frames"
            )
            if thin < 1.0:
                ranked.append((thin, axis.task, reason))
    best: dict[str, str] = {}
    for _, task, reason in sorted(ranked):
        best.setdefault(task, reason)
    return tuple(best.items())
