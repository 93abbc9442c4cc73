"""Pairs to a Parquet file and back, its contents' hash, and statistics of what is in it."""

import hashlib
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio.reference.intent import STATES
from studio.takes.dataset.pairs import SHAPES, Pairs

_NAMES = ("take", "state", "tick")


def schema() -> pa.Schema:
    """Columns of pairs.parquet: take, state, tick, then fixed-size lists of float32."""
    kinds = [("take", pa.int32()), ("state", pa.uint8()), ("tick", pa.int32())]
    lists = [(name, pa.list_(pa.float32(), shape[0])) for name, shape in SHAPES.items()]
    return pa.schema([*kinds, *lists])


def table_of(found: Pairs, number: int, use: NDArray[np.bool_] | None = None) -> pa.Table:
    """Rows of pairs.parquet of one take; use (N,): which of its N pairs.

    Columns, shapes and units of `pairs.SHAPES`.
    """
    use = np.ones(len(found), dtype=bool) if use is None else use
    cols: list[pa.Array] = [
        pa.array(np.full(int(use.sum()), number, np.int32)),
        pa.array(found.state[use]),
        pa.array(found.tick[use]),
    ]
    for name, (size,) in SHAPES.items():
        flat = pa.array(np.ascontiguousarray(found.values[name][use]).ravel())
        cols.append(pa.FixedSizeListArray.from_arrays(flat, size))
    return pa.Table.from_arrays(cols, schema=schema())


def read_table(path: Path) -> dict[str, NDArray[Any]]:
    """The arrays (N, …) of a pairs.parquet: take, state, tick, and those of `pairs.SHAPES` (SI)."""
    table = pq.read_table(path).combine_chunks()
    out: dict[str, NDArray[Any]] = {name: table[name].to_numpy() for name in _NAMES}
    for name, shape in SHAPES.items():
        column = table[name].combine_chunks()
        if isinstance(column, pa.ChunkedArray):
            column = pa.concat_arrays(column.chunks or [pa.array([], column.type)])
        out[name] = column.flatten().to_numpy(zero_copy_only=False).reshape(-1, *shape)
    return out


def content_hash(arrays: dict[str, NDArray[Any]]) -> str:
    """A hash (64 hex digits) of the arrays of `read_table`, whatever the file's encoding."""
    digest = hashlib.sha256()
    for name in (*_NAMES, *SHAPES):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(arrays[name]).tobytes())
    return digest.hexdigest()


def statistics(arrays: dict[str, NDArray[Any]]) -> dict[str, Any]:
    """Per state: count, and mean, std, min and max of every column of every array of `read_table`.

    In the units of the arrays (N, …).
    """
    out: dict[str, Any] = {}
    for i, state in enumerate(STATES):
        rows = arrays["state"] == i
        if not rows.any():
            continue
        out[state] = {"count": int(rows.sum())}
        for name in SHAPES:
            x = arrays[name][rows].astype(np.float64)
            kinds = {"mean": x.mean(0), "std": x.std(0), "min": x.min(0), "max": x.max(0)}
            out[state][name] = {k: np.round(v, 6).tolist() for k, v in kinds.items()}
    return out
