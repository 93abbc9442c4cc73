"""A take to files other programs read; one function per format, listed in FORMATS.

Every export covers the take's trim (the whole take without one) and never changes it.
"""

import csv
from collections.abc import Callable
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError, unknown_name
from studio.human.pose import HumanPose
from studio.recording import codec
from studio.recording.export.bvh import write_bvh
from studio.recording.take import Take
from studio.robot import a1


def tick_range(take: Take) -> tuple[int, int]:
    """First tick and one past the last of what the trim leaves."""
    if take.edits.trim is None:
        return 0, len(take)
    start, end = (round(s * a1.CONTROL_HZ) for s in take.edits.trim)
    return min(start, len(take)), min(end, len(take))


def human_poses(take: Take) -> list[HumanPose]:
    """The fresh human poses within the trim."""
    start, end = tick_range(take)
    used = [n for n in take.human_tick.tolist() if start <= n < end]
    return [pose for n in used if (pose := take.ticks[n].human) is not None]


def write_frames(take: Take, path: Path) -> None:
    """Human frames of contract.md, a JSON object a line: opens as source frames:FILE."""
    lines = [codec.encode_human(pose) for pose in _some_poses(take)]
    path.write_bytes(b"\n".join(lines) + b"\n")


def write_npz(take: Take, path: Path) -> None:
    """Arrays per tick: t, reference_*, robot_*, action, target, human_pos (T, 19, 3), human_index
    (-1 before the first), expert, state; and meta (JSON), dt, lag."""
    start, end = tick_range(take)
    arrays, cut = take.arrays, slice(start, end)
    out: dict[str, NDArray] = {
        "t": arrays.t[cut],
        "index": arrays.index[cut],
        "human_index": arrays.human_index[cut],
        "action": arrays.action[cut],
        "target": arrays.target[cut],
        "expert": np.array(arrays.expert[cut]),
        "state": np.array(arrays.state[cut]),
        "dt": np.array(a1.CONTROL_DT),
        "lag": np.array(take.edits.lag or 0.0),
        "meta": np.array(msgspec.json.encode(take.meta | {"label": take.label}).decode()),
    }
    for prefix, group in (("reference", arrays.reference), ("robot", arrays.robot)):
        out |= {f"{prefix}_{key}": value[cut] for key, value in group.items()}
    if take.human is not None:
        out["human_t"] = take.human.t
        out["human_pos"] = take.human.joint_pos_w
        out["human_confidence"] = take.human.confidence
    with path.open("wb") as file:
        np.savez_compressed(file, **out)  # type: ignore[arg-type]


def write_csv(take: Take, path: Path) -> None:
    """A row per tick: time, names, reference, robot and target, a column per number."""
    start, end = tick_range(take)
    with path.open("w", newline="") as file:
        writer = csv.writer(file)
        writer.writerow(["t", "expert", "state", *_columns()])
        for tick in take.ticks[start:end]:
            values = [getattr(tick.reference, k).ravel() for k in codec.REFERENCE_SHAPES]
            values += [getattr(tick.robot, k).ravel() for k in codec.ROBOT_SHAPES]
            numbers = np.round(np.concatenate([*values, tick.target]), codec.DECIMALS)
            writer.writerow([round(tick.t, 6), tick.expert, tick.state, *numbers.tolist()])


def _columns() -> list[str]:
    out = []
    for prefix, shapes in (("reference", codec.REFERENCE_SHAPES), ("robot", codec.ROBOT_SHAPES)):
        for key, shape in shapes.items():
            parts = a1.JOINTS if shape == (12,) else [str(i) for i in range(int(np.prod(shape)))]
            out += [f"{prefix}_{key}_{part}" for part in parts]
    return out + [f"target_{joint}" for joint in a1.JOINTS]


def write_human_bvh(take: Take, path: Path) -> None:
    """The human as a BVH at the mean rate of the poses."""
    poses = _some_poses(take)
    seconds = poses[-1].t - poses[0].t
    dt = seconds / (len(poses) - 1) if len(poses) > 1 and seconds > 0.0 else a1.CONTROL_DT
    write_bvh(path, np.array([pose.joint_pos_w for pose in poses]), dt)


def _some_poses(take: Take) -> list[HumanPose]:
    poses = human_poses(take)
    if not poses:
        raise StudioError(f"take {take.name} has no human motion to export; try npz or csv")
    return poses


FORMATS: dict[str, tuple[str, Callable[[Take, Path], None]]] = {
    "jsonl": (".jsonl", write_frames),
    "npz": (".npz", write_npz),
    "csv": (".csv", write_csv),
    "bvh": (".bvh", write_human_bvh),
}
"""Name of a format: its file's suffix, its writer."""


def export(take: Take, format_name: str, path: Path) -> Path:
    """Write a take in a format of FORMATS; `path` may be a folder. The file's path."""
    if format_name not in FORMATS:
        raise unknown_name("format", format_name, FORMATS)
    suffix, write = FORMATS[format_name]
    path = path / f"{take.name}{suffix}" if path.is_dir() else path
    try:
        write(take, path)
    except OSError as error:
        raise StudioError(f"cannot write {path}: {error.strerror}") from error
    return path
