"""A take to numpy's NPZ: every stream as arrays over its ticks."""

from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.robot import a1
from studio.takes.export.extent import tick_range
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
