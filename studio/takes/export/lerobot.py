"""Takes to a folder in the layout of LeRobotDataset v3.0, without lerobot.

An episode is a stretch of a take without a gap. meta/info.json, meta/stats.json,
meta/tasks.parquet, meta/episodes/chunk-000/file-000.parquet, data/chunk-000/file-NNN.parquet; no
videos. meta/a1_studio.json says which take each came from: `lerobot_read` brings them back.
Layout: https://huggingface.co/docs/lerobot
"""

from collections.abc import Iterable
from itertools import groupby
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio.human.skeleton import JOINTS
from studio.robot import a1
from studio.takes.export import lerobot_meta as meta
from studio.takes.export.episodes import Episode, episodes, twist, words
from studio.takes.take import Take

Array = NDArray[Any]

_POSE = ("base_x", "base_y", "base_z", "base_qw", "base_qx", "base_qy", "base_qz")
_TWIST = ("base_vx", "base_vy", "base_vz", "base_wx", "base_wy", "base_wz")
_POSITIONS = tuple(f"{joint}.pos" for joint in a1.JOINTS)
_CONTACTS = tuple(f"{leg}.contact" for leg in a1.LEGS)
NAMES: dict[str, tuple[str, ...]] = {
    "observation.state": (
        *_POSE, *_POSITIONS, *(f"{joint}.vel" for joint in a1.JOINTS), *_TWIST, *_CONTACTS,
    ),
    "observation.environment_state": (
        "pelvis.height",
        *(f"{joint}.{axis}" for joint in JOINTS[1:] for axis in "xyz"),
        *(f"{joint}.confidence" for joint in JOINTS),
    ),
    "observation.reference": (*_POSE, *_POSITIONS, *_CONTACTS),
    "observation.human": tuple(f"{joint}.{axis}" for joint in JOINTS for axis in "xyz"),
    "observation.human_confidence": JOINTS,
    "action": _POSITIONS,
}  # fmt: skip
"""Vector features (float32). state: the simulated A1 before the action (base in the world, its
twist in its own frame). environment_state: the person, who is what a policy reacts to: joints from
the pelvis, its height, and how surely each was seen, wherever the person stands. reference: what
was shown or retargeted. human: as measured, m, in step with the robot. action: PD target, rad."""
_DATA = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
_FRAMES = 100_000
"""Frames in a data file before the next is begun, about 100 MB; an episode is in one."""


def write_lerobot(takes: Iterable[Take], folder: Path) -> None:
    """Write episodes of these takes into a new folder, one take in memory at a time.

    StudioError when nothing is left of one of them.
    """
    rows: list[dict[str, Any]] = []
    tasks: dict[str, int] = {}
    origin: list[dict[str, Any]] = []
    first = 0
    writer: pq.ParquetWriter | None = None
    file, begun = -1, 0
    try:
        for take in takes:
            found = episodes(take)
            origin.append(_origin(take, len(rows), found))
            task = tasks.setdefault(words(take), len(tasks))
            for part in found:
                if writer is None or first - begun + len(part) > _FRAMES:
                    if writer is not None:
                        writer.close()
                    file, begun = file + 1, first
                    path = folder / _DATA.format(chunk_index=0, file_index=file)
                    path.parent.mkdir(parents=True, exist_ok=True)
                    writer = pq.ParquetWriter(path, meta.schema(NAMES), compression="snappy")
                arrays = features(part) | _indices(part, len(rows), first, task)
                writer.write_table(meta.data_table(arrays, NAMES))
                rows.append(meta.episode_row(len(rows), words(take), file, first, arrays))
                first += len(part)
    finally:
        if writer is not None:
            writer.close()
    meta.write(folder, NAMES, _DATA, file + 1, rows, list(tasks), {"takes": origin})


def features(part: Episode) -> dict[str, Array]:
    """The vector features (N, …) float32 of NAMES."""
    pelvis = part.human[:, :1]
    around = (part.human - pelvis)[:, 1:].reshape(len(part), -1)
    out = {
        "observation.state": [
            *_of(part.before, "base_pos", "base_quat", "joint_pos", "joint_vel"),
            twist(part.before),
            part.before["foot_contact"],
        ],
        "observation.environment_state": [pelvis[:, 0, 2:], around, part.confidence],
        "observation.reference": _of(
            part.reference, "base_pos", "base_quat", "joint_pos", "foot_contact"
        ),
        "observation.human": [part.human.reshape(len(part), -1)],
        "observation.human_confidence": [part.confidence],
        "action": [part.action],
    }
    return {key: np.concatenate(x, axis=1).astype(np.float32) for key, x in out.items()}


def _of(group: dict[str, Array], *keys: str) -> list[Array]:
    return [group[key] for key in keys]


def _indices(part: Episode, number: int, first: int, task: int) -> dict[str, Array]:
    frame = np.arange(len(part))
    return {
        "timestamp": (frame / a1.CONTROL_HZ).astype(np.float32),
        "frame_index": frame,
        "episode_index": np.full(len(part), number),
        "index": frame + first,
        "task_index": np.full(len(part), task),
    }


def _origin(take: Take, first: int, found: list[Episode]) -> dict[str, Any]:
    """What of a take its episodes do not hold; of where it was made nothing."""
    about = take.meta.get("about") or {}
    return {
        "name": take.name,
        "label": take.label,
        "about": {key: about[key] for key in ("collect", "style") if key in about},
        "lag": take.edits.lag or 0.0,
        "episodes": [first + i for i in range(len(found))],
        "first_ticks": [int(part.tick[0]) for part in found],
        "states": [_runs(take.ticks[n].state for n in part.tick) for part in found],
    }


def _runs(names: Iterable[str]) -> list[tuple[str, int]]:
    return [(name, len(list(run))) for name, run in groupby(names)]
