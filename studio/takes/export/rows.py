"""A take to CSV: a row per tick, a column per number."""

import csv
from pathlib import Path

import numpy as np

from studio.robot import a1
from studio.takes.export.extent import tick_range
from studio.takes.record import codec
from studio.takes.take import Take
from studio.takes.tick import fields_in

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
