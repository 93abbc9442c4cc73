"""What LeRobotDataset v3.0 keeps beside its frames: schema, episodes, tasks, statistics, info."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio.robot import a1

Array = NDArray[Any]
Names = Mapping[str, Sequence[str]]

INDICES = ("frame_index", "episode_index", "index", "task_index")
EPISODES, TASKS = "meta/episodes/chunk-000/file-000.parquet", "meta/tasks.parquet"
INFO, STATS, ORIGIN = "meta/info.json", "meta/stats.json", "meta/a1_studio.json"
_QUANTILES = {"q01": 0.01, "q10": 0.10, "q50": 0.50, "q90": 0.90, "q99": 0.99}


def schema(names: Names) -> pa.Schema:
    """Columns of a data file: fixed-size lists of float32, then the time and the indices."""
    vectors = [(key, pa.list_(pa.float32(), len(of))) for key, of in names.items()]
    return pa.schema([*vectors, ("timestamp", pa.float32()), *((k, pa.int64()) for k in INDICES)])


def data_table(arrays: Mapping[str, Array], names: Names) -> pa.Table:
    """An episode's frames: arrays (T, …) by key, those of `names` as fixed-size lists."""
    columns: list[pa.Array] = []
    for key, of in names.items():
        flat = pa.array(np.ascontiguousarray(arrays[key]).ravel())
        columns.append(pa.FixedSizeListArray.from_arrays(flat, len(of)))
    columns.append(pa.array(arrays["timestamp"], pa.float32()))
    columns += [pa.array(arrays[key], pa.int64()) for key in INDICES]
    return pa.Table.from_arrays(columns, schema=schema(names))


def read_columns(path: Path, key: str) -> Array:
    """A column of a data file, (T, …)."""
    column = pq.read_table(path, columns=[key])[key].combine_chunks()
    if isinstance(column, pa.ChunkedArray):  # of no chunk, or of several
        column = pa.concat_arrays(column.chunks)
    if pa.types.is_fixed_size_list(column.type):
        return np.asarray(column.flatten()).reshape(-1, column.type.list_size)
    return np.asarray(column)


def episode_row(
    number: int, task: str, file: int, first: int, arrays: Mapping[str, Array]
) -> dict[str, Any]:
    """A row of the table of episodes; arrays (T, …) of the episode, in the data set's units.

    first: row of the data set at which it begins; file: the number of its data file.
    """
    length = len(arrays["index"])
    row: dict[str, Any] = {
        "episode_index": number,
        "tasks": [task],
        "length": length,
        "data/chunk_index": 0,
        "data/file_index": file,
        "dataset_from_index": first,
        "dataset_to_index": first + length,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": 0,
    }
    for key, x in arrays.items():
        row |= {f"stats/{key}/{name}": value for name, value in statistics(x).items()}
    return row


def statistics(x: Array) -> dict[str, list[Any]]:
    """min, max, mean, std, quantiles and count of every column of (N, …)."""
    flat = x.reshape(len(x), -1).astype(np.float64)
    out = {"min": flat.min(0), "max": flat.max(0), "mean": flat.mean(0), "std": flat.std(0)}
    out |= {name: np.quantile(flat, q, axis=0) for name, q in _QUANTILES.items()}
    return {key: value.tolist() for key, value in out.items()} | {"count": [len(x)]}


def write(
    folder: Path,
    names: Names,
    data: str,
    files: int,
    rows: list[dict[str, Any]],
    tasks: list[str],
    origin: dict[str, Any],
) -> None:
    """The folder `meta` of the data files (`data`: their pattern) that lie in `folder`."""
    (folder / EPISODES).parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(pa.Table.from_pylist(rows), folder / EPISODES, compression="snappy")
    pq.write_table(_tasks_table(tasks), folder / TASKS, compression="snappy")
    paths = [folder / data.format(chunk_index=0, file_index=i) for i in range(files)]
    # A column at a time: the whole of a year's takes need not fit into memory.
    stats = {
        key: statistics(np.concatenate([read_columns(path, key) for path in paths]))
        for key in schema(names).names
    }
    _json(folder / STATS, stats)
    _json(folder / ORIGIN, {"format": "a1-studio episodes", "format_version": 1} | origin)
    frames = sum(row["length"] for row in rows)
    _json(folder / INFO, _info(names, data, len(rows), len(tasks), frames))


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


def _info(names: Names, data: str, episodes: int, tasks: int, frames: int) -> dict[str, Any]:
    features: dict[str, Any] = {
        key: {"dtype": "float32", "shape": [len(of)], "names": list(of)}
        for key, of in names.items()
    }
    features["timestamp"] = {"dtype": "float32", "shape": [1], "names": None}
    features |= {key: {"dtype": "int64", "shape": [1], "names": None} for key in INDICES}
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
        "data_path": data,
        "video_path": None,
        "features": features,
    }


def _json(path: Path, value: dict[str, Any]) -> None:
    path.write_bytes(msgspec.json.format(msgspec.json.encode(value), indent=4))
