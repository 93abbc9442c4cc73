"""Parts of a take's table to what a player and a timeline draw, both sides together."""

from typing import Any

import numpy as np

from studio.robot import a1
from studio.takes.align import alignment
from studio.takes.columns import Columns
from studio.takes.edit.edited import human_at, human_rows, kept
from studio.takes.edit.edits import Edits

MOST_FRAMES = 1800
"""Frames a window holds at most; longer windows are thinned."""


def window(
    table: Columns,
    edits: Edits,
    start: float,
    end: float,
    *,
    aligned: bool = True,
    most: int = MOST_FRAMES,
) -> dict[str, Any]:
    """Both sides between two times (s), for a player: arrays of at most `most` frames.

    t (N,) s; human (N, 19, 3) m and confidence; reference_* and robot_* poses; state (N,) names;
    kept (N,). aligned: the human as lag and warp put it; else as it was recorded.
    """  # fmt: skip
    a = int(np.clip(start * a1.CONTROL_HZ, 0, len(table)))
    b = int(np.clip(np.ceil(end * a1.CONTROL_HZ), a, len(table)))
    step = max(1, -(-(b - a) // most))
    ticks = np.arange(a, b, step)
    rows = table.rows[a:b:step]
    human, confidence = human_at(
        table, human_rows(ticks, edits) if aligned else ticks.astype(np.float64)
    )
    out: dict[str, Any] = {
        "t": ticks / a1.CONTROL_HZ,
        "human": human,
        "confidence": confidence,
        "state": [table.names[i] for i in rows["state"]],
        "kept": kept(len(table), edits)[a:b:step],
    }
    for who in ("reference", "robot"):
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact"):
            out[f"{who}_{key}"] = np.asarray(rows[f"{who}_{key}"], dtype=np.float64)
    return out


def overview(table: Columns, edits: Edits, points: int = 600) -> dict[str, Any]:
    """The whole take at `points` instants, for a timeline: t (N,) s, human and robot (N, 7) in
    units of `alignment.CHANNELS`, aligned as the edits have it, state (N,) names."""
    count = min(max(2, points), len(table))
    ticks = np.unique(np.linspace(0, len(table) - 1, count).astype(int))
    rows = table.rows[ticks]
    # Row by row where the human is sought: fancy indexing reads only these pages.
    at = np.clip(np.rint(human_rows(ticks, edits)).astype(int), 0, len(table) - 1)
    human = np.asarray(table.rows["human"][at], dtype=np.float64)
    robot = [
        np.asarray(rows[f"reference_{key}"], dtype=np.float64)
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    ]
    return {
        "t": ticks / a1.CONTROL_HZ,
        "channels": list(alignment.CHANNELS),
        "human": alignment.scaled_human(alignment.human_channels(human)),
        "robot": alignment.scaled_robot(alignment.robot_channels(*robot)),
        "state": [table.names[i] for i in rows["state"]],
    }
