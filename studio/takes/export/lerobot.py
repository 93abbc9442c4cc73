"""Takes to a folder in the layout of LeRobotDataset v3.0, an episode a take, without lerobot.

meta/info.json, meta/stats.json, meta/tasks.parquet, meta/episodes/chunk-000/file-000.parquet,
data/chunk-000/file-000.parquet; no videos. Layout: https://huggingface.co/docs/lerobot
"""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.skeleton import JOINTS
from studio.robot import a1
from studio.takes.export.extent import extent
from studio.takes.take import Take

Array = NDArray[Any]

_POSE = ("base_x", "base_y", "base_z", "base_qw", "base_qx", "base_qy", "base_qz")
_POSITIONS = tuple(f"{joint}.pos" for joint in a1.JOINTS)
NAMES: dict[str, tuple[str, ...]] = {
    "observation.state": (*_POSE, *_POSITIONS, *(f"{joint}.vel" for joint in a1.JOINTS)),
    "observation.reference": (*_POSE, *_POSITIONS, *(f"{leg}.contact" for leg in a1.LEGS)),
    "observation.human": tuple(f"{joint}.{axis}" for joint in JOINTS for axis in "xyz"),
    "observation.human_confidence": JOINTS,
    "action": _POSITIONS,
}
"""Vector features (float32). state: the simulated A1; reference: what was shown or retargeted;
human: m, in step with the robot; action: the PD target, rad."""
_INDICES = ("frame_index", "episode_index", "index", "task_index")
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def write_lerobot(takes: Sequence[Take], folder: Path) -> None:
    """Write episodes of these takes into a new folder. StudioError when nothing is left of them."""
    if folder.exists() and any(folder.iterdir()):
        raise StudioError(f"{folder} is there already: choose a new folder")
    columns, episodes, tasks = [], [], list(dict.fromkeys(_task(take) for take in takes))
    first = 0
    for number, take in enumerate(takes):
        arrays = episode(take)
        length = len(arrays["action"])
        if not length:
            raise StudioError(f"nothing is left of take {take.name}: widen its trim")
        frame = np.arange(length)
        task = tasks.index(_task(take))
        arrays |= {
            "timestamp": (frame / a1.CONTROL_HZ).astype(np.float32),
            "frame_index": frame,
            "episode_index": np.full(length, number),
            "index": frame + first,
            "task_index": np.full(length, task),
        }
        columns.append(arrays)
        episodes.append(_episode_row(number, _task(take), first, arrays))
        first += length
    whole = {key: np.concatenate([c[key] for c in columns]) for key in columns[0]}
    _save(folder / _DATA.format(chunk_index=0, file_index=0), _data_table(whole))
    _save(folder / "meta/episodes/chunk-000/file-000.parquet", pa.Table.from_pylist(episodes))
    _save(folder / "meta/tasks.parquet", _tasks_table(tasks))
    _json(folder / "meta/stats.json", {key: _stats(x) for key, x in whole.items()})
    _json(folder / "meta/info.json", _info(len(takes), len(tasks), first))


def episode(take: Take) -> dict[str, Array]:
    """The vector features (N, …) float32 of the ticks that trim and cuts leave."""
    part = extent(take)
    robot, shown = take.arrays.robot, take.arrays.reference

    def of(group: dict[str, Array], *keys: str) -> Array:
        parts = [group[key][part.tick].reshape(len(part.tick), -1) for key in keys]
        return np.concatenate(parts, axis=1).astype(np.float32)

    return {
        "observation.state": of(robot, "base_pos", "base_quat", "joint_pos", "joint_vel"),
        "observation.reference": of(shown, "base_pos", "base_quat", "joint_pos", "foot_contact"),
        "observation.human": part.human.reshape(len(part.tick), -1).astype(np.float32),
        "observation.human_confidence": part.confidence.astype(np.float32),
        "action": take.arrays.target[part.tick].astype(np.float32),
    }


def _task(take: Take) -> str:
    return take.label or "free motion"


def _data_table(whole: dict[str, Array]) -> pa.Table:
    columns: dict[str, pa.Array] = {}
    for key, names in NAMES.items():
        flat = pa.array(np.ascontiguousarray(whole[key]).ravel())
        columns[key] = pa.FixedSizeListArray.from_arrays(flat, len(names))
    columns["timestamp"] = pa.array(whole["timestamp"], pa.float32())
    for key in _INDICES:
        columns[key] = pa.array(whole[key], pa.int64())
    return pa.table(columns)


def _episode_row(number: int, task: str, first: int, arrays: dict[str, Array]) -> dict[str, Any]:
    length = len(arrays["action"])
    row: dict[str, Any] = {
        "episode_index": number,
        "tasks": [task],
        "length": length,
        "data/chunk_index": 0,
        "data/file_index": 0,
        "dataset_from_index": first,
        "dataset_to_index": first + length,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }
    for key, x in arrays.items():
        row |= {f"stats/{key}/{name}": value for name, value in _stats(x).items()}
    return row


def _stats(x: Array) -> dict[str, list[Any]]:
    flat = x.reshape(len(x), -1).astype(np.float64)
    out = {"min": flat.min(0), "max": flat.max(0), "mean": flat.mean(0), "std": flat.std(0)}
    out |= {name: np.quantile(flat, q, axis=0) for name, q in _QUANTILES.items()}
    return {key: value.tolist() for key, value in out.items()} | {"count": [len(x)]}


def _tasks_table(tasks: list[str]) -> pa.Table:
    """task_index by task; the task is the index of the data frame that pandas makes of it."""
    about = {
        "index_columns": ["task"],
        "column_indexes": [
            {"name": None, "field_name": None, "pandas_type": "unicode", "numpy_type": "object",
             "metadata": {"encoding": "UTF-8"}}
        ],
        "columns": [
            {"name": "task_index", "field_name": "task_index", "pandas_type": "int64",
             "numpy_type": "int64", "metadata": None},
            {"name": "task", "field_name": "task", "pandas_type": "unicode",
             "numpy_type": "object", "metadata": None},
        ],
        "creator": {"library": "pyarrow", "version": pa.__version__},
        "pandas_version": "2.0.0",
    }  # fmt: skip
    table = pa.table({"task_index": pa.array(range(len(tasks)), pa.int64()), "task": tasks})
    return table.replace_schema_metadata({"pandas": msgspec.json.encode(about)})


def _info(episodes: int, tasks: int, frames: int) -> dict[str, Any]:
    features: dict[str, Any] = {
        key: {"dtype": "float32", "shape": [len(names)], "names": list(names)}
        for key, names in NAMES.items()
    }
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    features |= {key: {"dtype": "int64", "shape": [1], "names": None} for key in _INDICES}
    return {
        "codebase_version": "v3.0",
        "robot_type": "unitree_a1",
        "total_episodes": episodes,
        "total_frames": frames,
        "total_tasks": tasks,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "fps": round(a1.CONTROL_HZ),
        "splits": {"train": f"0:{episodes}"},
        "data_path": _DATA,
        "video_path": None,
        "features": features,
    }


def _save(path: Path, table: pa.Table) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path, compression="snappy")


def _json(path: Path, value: dict[str, Any]) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_bytes(msgspec.json.format(msgspec.json.encode(value), indent=4))
