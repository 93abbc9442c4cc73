"""One take to a plain file: NumPy arrays, a CSV, human frames, a Parquet of its pairs."""

import csv
from pathlib import Path

import msgspec
import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.features import FEATURE_NAMES
from studio.reference.intent import STATES
from studio.robot import a1
from studio.takes.dataset.datasets import code_version
from studio.takes.dataset.pairs import take_pairs, why_none
from studio.takes.dataset.pairs_file import table_of
from studio.takes.export.bvh import some_poses
from studio.takes.export.extent import tick_range
from studio.takes.record import codec
from studio.takes.session_library import SessionLibrary
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


def write_frames(take: Take, path: Path) -> None:
    """Human frames of docs/contract.md (skeleton "studio") within the trim."""
    lines = [codec.encode("human", pose) for pose in some_poses(take)]
    path.write_bytes(b"\n".join(lines) + b"\n")


def write_pairs(take: Take, path: Path) -> None:
    """Columns of `datasets.schema`; the file's metadata names them. StudioError without a pair."""
    library = SessionLibrary(take.path.parent)
    found = take_pairs(library, take.name)
    if not len(found):
        raise StudioError(why_none(library, take.name))
    about = {
        "take": take.name,
        "label": found.label,
        "lag": found.lag,
        "aligned": found.aligned,
        "code": code_version(),
        "states": STATES,
        "features": FEATURE_NAMES,
        "joints": a1.JOINTS,
        "fps": a1.CONTROL_HZ,
    }
    table = table_of(found, 0).replace_schema_metadata({"a1_studio": msgspec.json.encode(about)})
    pq.write_table(table, path, compression="zstd")
