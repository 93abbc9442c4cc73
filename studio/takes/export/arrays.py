"""A take to numpy's NPZ: every stream as arrays over its ticks."""

from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.robot import a1
from studio.takes.export.extent import tick_range
from studio.takes.take import Take


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
