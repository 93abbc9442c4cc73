"""A take to what was asked of the robot beside what it did, as numbers over time, for plots.

The same signals, by the same names, as the page plots of the last seconds (js/signals.js).
"""

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.metrics import joint_error_sq
from studio.robot import a1
from studio.takes.columns import Columns

Array = NDArray[np.float64]

TURN_OVER = 6
"""Ticks over which a turn is measured."""
LAG_OVER = 90
"""Ticks that a lag is looked for over."""
LAG_MOST = 12
"""Ticks that a lag can be at most."""
MOVES = 0.02
"""rad, RMS: where the joints asked for move less there is no lag to see."""
_BEFORE = LAG_OVER + LAG_MOST
_BLOCK = 8192


def series(table: Columns, points: int) -> dict[str, Array]:
    """Signals (N,) of a take, N the least of `points` and its ticks; each named with its unit.

    t_s: s into the take. Where a value stands for several ticks it is the one that lies furthest
    from their mean: a fall of three ticks is seen in an hour. joints_late_ms is NaN where the
    joints do not move, and before enough of the take has passed.
    """
    count = len(table)
    blocks = []
    for start in range(0, count, _BLOCK):
        first = max(0, start - _BEFORE)
        found = signals(table.rows[first : start + _BLOCK])
        blocks.append({name: values[start - first :] for name, values in found.items()})
    whole = {name: np.concatenate([block[name] for block in blocks]) for name in blocks[0]}
    t = np.arange(count) / a1.CONTROL_HZ
    if count <= points:
        return {"t_s": t, **whole}
    edges = np.linspace(0, count, points + 1).astype(int)
    return {
        "t_s": t[(edges[:-1] + edges[1:]) // 2],
        **{name: _extremes(values, edges) for name, values in whole.items()},
    }


def signals(rows: NDArray) -> dict[str, Array]:
    """The signals (T,) of rows (T,) of a take's table, from the first on."""
    out: dict[str, Array] = {}
    joints = {}
    for stream, who in (("reference", "asked"), ("robot", "done")):
        quat = np.asarray(rows[f"{stream}_base_quat"], dtype=np.float64)
        roll, pitch, yaw = np.moveaxis(geometry.quat_to_rpy(quat), -1, 0)
        velocity = np.asarray(rows[f"{stream}_base_lin_vel_w"], dtype=np.float64)
        out[f"speed_{who}_m_s"] = velocity[:, 0] * np.cos(yaw) + velocity[:, 1] * np.sin(yaw)
        out[f"turn_{who}_deg_s"] = _turn(yaw)
        out[f"roll_{who}_deg"] = np.degrees(roll)
        out[f"pitch_{who}_deg"] = np.degrees(pitch)
        out[f"height_{who}_cm"] = 100.0 * rows[f"{stream}_base_pos"][:, 2].astype(np.float64)
        joints[who] = np.asarray(rows[f"{stream}_joint_pos"], dtype=np.float64)
    paws = 100.0 * rows["robot_foot_pos_w"][:, :2, 2].astype(np.float64)
    out["paw_right_cm"], out["paw_left_cm"] = paws.T
    misses = joint_error_sq(joints["asked"], joints["done"])
    out["joint_error_deg"] = np.degrees(np.sqrt(misses))
    out["joints_late_ms"] = _late(joints["asked"], joints["done"])
    return out


def _turn(yaw: Array) -> Array:
    """(T,) deg/s, over the ticks before; 0 before there are as many."""
    out = np.zeros(len(yaw))
    turned = yaw[TURN_OVER:] - yaw[:-TURN_OVER]
    out[TURN_OVER:] = np.degrees(geometry.wrap_angle(turned))
    return out * a1.CONTROL_HZ / TURN_OVER


def _late(asked: Array, done: Array) -> Array:
    """(T,) ms by which the joints done (T, 12) follow those asked for, over the ticks before."""
    count = len(asked) - _BEFORE + 1
    out = np.full(len(asked), np.nan)
    if count <= 0:
        return out
    misses = np.empty((LAG_MOST + 1, count))
    for shift in range(LAG_MOST + 1):
        apart = joint_error_sq(asked[LAG_MOST - shift : len(asked) - shift], done[LAG_MOST:])
        summed = np.cumsum(np.concatenate([[0.0], apart]))
        misses[shift] = summed[LAG_OVER:] - summed[:-LAG_OVER]
    window = asked[LAG_MOST:]
    moved = np.zeros(count)
    for later in range(1, LAG_OVER):
        np.maximum(moved, joint_error_sq(window[later : later + count], window[:count]), out=moved)
    late = 1000.0 * a1.CONTROL_DT * np.argmin(misses, axis=0)
    out[_BEFORE - 1 :] = np.where(np.sqrt(moved) < MOVES, np.nan, late)
    return out


def _extremes(values: Array, edges: NDArray[np.int64]) -> Array:
    """(N,) of values (T,): of each stretch between edges (N + 1,) what lies furthest off."""
    out = np.full(len(edges) - 1, np.nan)
    for i, (start, end) in enumerate(pairwise(edges)):
        stretch = values[start:end]
        stretch = stretch[np.isfinite(stretch)]
        if len(stretch):
            out[i] = stretch[np.argmax(np.abs(stretch - stretch.mean()))]
    return out
