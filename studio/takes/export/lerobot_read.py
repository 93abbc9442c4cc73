"""A LeRobotDataset that we exported, or that was made of such ones, back to takes.

An episode of N steps becomes a take of N + 1 ticks: a step's state is the robot after the tick
before. What an episode does not hold (torques, votes) is zero; the reference's velocities are its
differences.
"""

import itertools
import os
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.files import opened
from studio.human.pose import HumanPose
from studio.human.skeleton import NUM_JOINTS
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.edit import edits
from studio.takes.export.adding import free_name, record_take
from studio.takes.export.lerobot import NAMES
from studio.takes.export.lerobot_meta import INFO, ORIGIN, TASKS
from studio.takes.names import fit_name
from studio.takes.tick import Tick
from studio.takes.untrusted import Count, Line, Name, read_json

Array = NDArray[np.float64]

_KEYS = (
    "observation.state", "observation.reference", "observation.human",
    "observation.human_confidence", "action",
)  # fmt: skip
_MOST = 1 << 28
_TASK = 1000
"""Characters of a task's words."""
_ROWS, _FEW = 200_000, 10_000
"""Rows of one table: we begin another file after 100,000 (an hour)."""
_ROW, _RATIO = sum(4 * len(NAMES[key]) for key in _KEYS), 20
"""Bytes of a row, and how far a file of rows may be packed; ours are by less than three."""


class _Feature(msgspec.Struct):
    names: Any = None


class _Info(msgspec.Struct):
    codebase_version: Name
    fps: float
    features: dict[Name, _Feature]


class _Origin(msgspec.Struct):
    name: Name
    label: Line
    about: dict[str, Any]
    episodes: list[Count]
    states: list[list[tuple[Name, Count]]]


class _Origins(msgspec.Struct):
    takes: list[_Origin]


_info, _origins = msgspec.json.Decoder(_Info), msgspec.json.Decoder(_Origins)


def is_lerobot(folder: Path) -> bool:
    """Whether a folder is a LeRobotDataset."""
    return (folder / INFO).is_file()


def import_lerobot(root: Path, folder: Path) -> dict[str, Any]:
    """Each episode as a take: {"takes": names here, "refused": {episode: why}}.

    They keep name and label where the data set still says so, and need no alignment: the person is
    in step. Raises StudioError for a data set that does not hold what we export.
    """
    _check(folder)
    known = _known(folder)
    taken, refused = [], {}
    for number, task, arrays in _episodes(folder):
        origin = known.get(number)
        states = ["idle"]
        if origin is not None:
            runs = origin.states[origin.episodes.index(number)]
            states = [name for name, length in runs[: len(arrays["action"])] for _ in range(length)]
        if origin is None or len(states) != len(arrays["action"]):  # edited since
            origin, states = None, ["idle"] * len(arrays["action"])
        try:
            name = free_name(root, origin.name if origin else fit_name(f"{folder.stem}-{number}"))
            label = origin.label if origin else task
            about = {"source": f"import:{folder.name}"} | (origin.about if origin else {})
            ticks = _ticks(arrays, states)
            taken.append(record_take(root, ticks, label=label, about=about, name=name))
            edits.record(root / taken[-1], lag=0.0)
        except (StudioError, ValueError) as error:
            refused[f"episode {number}"] = str(error)
    return {"takes": taken, "refused": refused}


def _check(folder: Path) -> None:
    try:
        info = read_json(folder / INFO, _info)
    except (OSError, ValueError) as error:
        why = f"{folder.name} is no LeRobotDataset that can be read: {error}"
        raise StudioError(why) from error
    if not info.codebase_version.startswith("v3"):
        raise StudioError(
            f"{folder.name} has LeRobotDataset {info.codebase_version}, v3.0 is read: convert it"
        )
    for key in _KEYS:
        if key not in info.features or info.features[key].names != list(NAMES[key]):
            raise StudioError(
                f"{folder.name} has no {key} of a person and an A1: only what a1-studio exported"
                " comes back"
            )
    if info.fps != a1.CONTROL_HZ:
        raise StudioError(f"{folder.name} has {info.fps:g} frames a second, not 30")


def _known(folder: Path) -> dict[int, _Origin]:
    """Where each episode came from, while nobody has changed the data set since."""
    try:
        found = read_json(folder / ORIGIN, _origins, _MOST)
    except (OSError, ValueError):
        return {}
    return {n: one for one in found.takes for n, _ in zip(one.episodes, one.states, strict=False)}


def _episodes(folder: Path) -> Iterator[tuple[int, str, dict[str, Array]]]:
    """Number, task and arrays of each episode, one data file in memory at a time."""
    try:
        _check_rows(folder / TASKS)
        tasks = pq.read_table(folder / TASKS)
        named = dict(zip(tasks["task_index"].to_pylist(), tasks["task"].to_pylist(), strict=True))
        for path in sorted((folder / "data").glob("chunk-*/file-*.parquet")):
            _check_rows(path)
            table = pq.read_table(path, columns=[*_KEYS, "episode_index", "task_index"])
            numbers = table["episode_index"].to_numpy()
            begins = np.flatnonzero(np.diff(numbers, prepend=numbers[:1] - 1))
            for first, end in itertools.pairwise([*begins.tolist(), len(numbers)]):
                part = table.slice(first, end - first)
                arrays = {key: _vectors(part[key], len(NAMES[key])) for key in _KEYS}
                task = named.get(part["task_index"][0].as_py(), "")
                yield int(numbers[first]), str(task)[:_TASK], arrays
    except (OSError, KeyError, ValueError, pa.ArrowException) as error:
        raise StudioError(f"{folder.name} cannot be read: {str(error)[:200]}") from error


def _check_rows(path: Path) -> None:
    """StudioError for a table that unpacks to more than one of ours."""
    with opened(path) as file:
        about, size = pq.read_metadata(file), os.fstat(file.fileno()).st_size
    most = max(_FEW, _RATIO * size // _ROW)
    if about.num_rows > min(_ROWS, most):
        raise StudioError(
            f"{path.parents[2].name}: {path.name} claims {about.num_rows} rows in {size} bytes, at"
            f" most {min(_ROWS, most)} are read: it is not as a1-studio exported it"
        )


def _vectors(column: pa.ChunkedArray, length: int) -> Array:
    """(T, length) of a column of lists; ValueError where one is of another length."""
    flat = [chunk.flatten().to_numpy(zero_copy_only=False) for chunk in column.chunks]
    return np.concatenate([np.zeros(0), *flat]).reshape(len(column), length).astype(np.float64)


def _ticks(arrays: dict[str, Array], states: list[str]) -> Iterator[Tick]:
    if not all(np.isfinite(x).all() for x in arrays.values()):
        raise StudioError("its numbers are not finite")
    state, reference = arrays["observation.state"], arrays["observation.reference"]
    human = arrays["observation.human"].reshape(-1, NUM_JOINTS, 3)
    sure, action = arrays["observation.human_confidence"], arrays["action"]
    shown = _references(reference)
    for i in range(len(action) + 1):
        row, step = min(i, len(action) - 1), max(i - 1, 0)
        seen = sure[step].any()
        yield Tick(
            index=i,
            t=i * a1.CONTROL_DT,
            human=HumanPose(
                t=i * a1.CONTROL_DT, joint_pos_w=human[step], confidence=sure[step]
            ) if seen else None,
            human_fresh=bool(seen),
            expert="unknown",
            votes={},
            state=states[step],
            transition_to=None,
            mode="collect",
            controller="imported",
            reference=shown[step],
            action=action[step],
            target=action[step],
            robot=_robot(state[row], (i + 1) * a1.CONTROL_DT),
            clipped=False,
            fallen=False,
        )  # fmt: skip


def _references(rows: Array) -> list[ReferencePose]:
    pos, quat, joint_pos, contact = np.split(rows, [3, 7, 19], axis=1)
    quat = geometry.normalize(quat)
    back = np.maximum(np.arange(len(rows)) - 1, 0)
    turn = geometry.quat_to_rotvec(geometry.quat_mul(geometry.quat_conj(quat[back]), quat))
    return [
        ReferencePose(
            base_pos=pos[i],
            base_quat=quat[i],
            joint_pos=joint_pos[i],
            foot_contact=contact[i],
            base_lin_vel_w=(pos[i] - pos[back[i]]) / a1.CONTROL_DT,
            base_ang_vel_b=turn[i] / a1.CONTROL_DT,
            joint_vel=(joint_pos[i] - joint_pos[back[i]]) / a1.CONTROL_DT,
        )
        for i in range(len(rows))
    ]


def _robot(row: Array, t: float) -> RobotState:
    pos, quat, joint_pos, joint_vel, linear, angular, contact = np.split(
        row, [3, 7, 19, 31, 34, 37]
    )
    quat = geometry.normalize(quat)
    return RobotState(
        t=t,
        base_pos=pos,
        base_quat=quat,
        joint_pos=joint_pos,
        foot_contact=contact,
        base_lin_vel_w=geometry.quat_rotate(quat, linear),
        base_ang_vel_b=angular,
        joint_vel=joint_vel,
        foot_pos_w=kinematics.foot_pos_w(pos, quat, joint_pos),
        torque=np.zeros(a1.NUM_JOINTS),
    )
