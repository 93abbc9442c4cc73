"""A take as plain numbers: numpy's NPZ, an array a field; CSV, a row a tick."""

import csv
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.robot import a1
from studio.takes.export.extent import tick_range
from studio.takes.record import codec
from studio.takes.take import Take
from studio.takes.tick import fields_in


def write_npz(take: Take, path: Path) -> None:
    """Arrays per tick: t, index, reference_*, robot_*, action, target, expert, state; human_index
    (-1 before the first) into human_t, human_pos (M, 19, 3); and meta (JSON), dt, lag."""
    start, end = tick_range(take)
    arrays, cut = take.arrays, slice(start, end)
    out: dict[str, NDArray] = {
        "human_index": arrays.human_index[cut],
        "dt": np.array(a1.CONTROL_DT),
        "lag": np.array(take.edits.lag or 0.0),
        "meta": np.array(msgspec.json.encode(take.meta | {"label": take.label}).decode()),
    }
    for stream in ("reference", "robot", "tick"):
        group = getattr(arrays, stream)
        out |= {f.column: np.array(group[f.attr][cut]) for f in fields_in("npz", stream)}
    if take.human is not None:
        out["human_t"] = take.human.t
        out["human_pos"] = take.human.joint_pos_w
        out["human_confidence"] = take.human.confidence
    with path.open("wb") as file:
        np.savez_compressed(file, **out)  # type: ignore[arg-type]


_STREAMS = {
    stream: [f for f in fields_in("npz", stream) if f.shape] for stream in ("reference", "robot")
}


def write_csv(take: Take, path: Path) -> None:
    """Time, names, reference, robot and target of each tick within the trim."""
    start, end = tick_range(take)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t", "expert", "state", *_columns()])
        for tick in take.ticks[start:end]:
            values = [
                getattr(getattr(tick, stream), field.attr).ravel()
                for stream, fields in _STREAMS.items()
                for field in fields
            ]
            numbers = np.round(np.concatenate([*values, tick.target]), codec.DECIMALS)
            writer.writerow([round(tick.t, 6), tick.expert, tick.state, *numbers.tolist()])


def _columns() -> list[str]:
    out = []
    for field in (field for fields in _STREAMS.values() for field in fields):
        shape = field.shape or ()
        parts = a1.JOINTS if shape == (12,) else [str(i) for i in range(int(np.prod(shape)))]
        out += [f"{field.column}_{part}" for part in parts]
    return out + [f"target_{joint}" for joint in a1.JOINTS]
