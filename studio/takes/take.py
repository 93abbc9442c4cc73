"""A take's folder back to what happened: ticks one by one, or arrays of all of them."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.pose import HumanClip
from studio.robot import a1
from studio.takes.edit.edits import Edits, read_edits
from studio.takes.record import codec
from studio.takes.record.meta import META, TAPE, MetaLost, read_meta
from studio.takes.record.tape import TapeScan
from studio.takes.tick import Tick, fields_in

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class TakeArrays:
    """A take as arrays over its T ticks; keys of each stream as in Tick, ReferencePose, RobotState.

    reference, robot: what exports hold of them.
    human_index: (T,) row of the take's `human` clip in use, -1 before the first.
    tick: of numbers an array, of what has names a list.
    """

    human_index: NDArray[np.int64]
    reference: dict[str, NDArray[Any]]
    robot: dict[str, NDArray[Any]]
    tick: dict[str, Any]

    @property
    def target(self) -> Array:
        """(T, 12) rad, the PD targets."""
        return self.tick["target"]

    @property
    def state(self) -> list[str]:
        """The state in each tick."""
        return self.tick["state"]


@dataclass(frozen=True, kw_only=True)
class Take:
    """One recording, read whole.

    meta: meta.json. edits: what was decided since (nothing below is trimmed or shifted by it).
    ticks: every whole control period. human: the fresh poses, None if there were none, at their
    source's own times counted from the first; human_tick: (M,) the tick that first used each.
    complete: it was stopped properly. recovered: it was not, and this is what is left.
    """

    name: str
    path: Path
    meta: dict[str, Any]
    edits: Edits
    ticks: list[Tick]
    human: HumanClip | None
    human_tick: NDArray[np.int64]
    complete: bool
    recovered: bool
    problems: tuple[str, ...]

    def __len__(self) -> int:
        return len(self.ticks)

    @property
    def seconds(self) -> float:
        """Duration, s."""
        return len(self.ticks) / a1.CONTROL_HZ

    @property
    def label(self) -> str:
        """The present label."""
        return self.meta.get("label", "") if self.edits.label is None else self.edits.label

    @cached_property
    def arrays(self) -> TakeArrays:
        """The ticks as arrays."""
        ticks = self.ticks
        index = np.arange(len(ticks))
        return TakeArrays(
            human_index=np.searchsorted(self.human_tick, index, side="right") - 1,
            reference=_stack([tick.reference for tick in ticks], "reference"),
            robot=_stack([tick.robot for tick in ticks], "robot"),
            tick=_stack(ticks, "tick"),
        )


def _stack(values: Sequence[Any], stream: str) -> dict[str, Any]:
    out: dict[str, Any] = {}
    for field in fields_in("tape" if stream == "tick" else "npz", stream):
        column = [getattr(value, field.attr) for value in values]
        kind = codec.bare(field.type)
        if field.shape is not None:
            out[field.attr] = np.array(column, dtype=np.float64).reshape(-1, *field.shape)
        else:
            out[field.attr] = np.array(column, kind) if kind in (bool, int, float) else column
    return out


@dataclass(frozen=True, kw_only=True)
class Survey:
    """What a tape holds, without holding it: fields as in Take."""

    ticks: int
    complete: bool
    problems: tuple[str, ...]

    @property
    def seconds(self) -> float:
        """Duration, s."""
        return self.ticks / a1.CONTROL_HZ


def survey_take(path: Path) -> Survey:
    """Read a take's folder (or its tape) tick by tick, in bounded memory. Errors as `read_take`."""
    folder, meta, problems = _open(path)
    found = TapeScan()
    count = sum(1 for _ in codec.read_ticks(folder / TAPE, found))
    problems += _troubles(found, meta, count)
    return Survey(ticks=count, complete=found.complete, problems=tuple(problems))


def read_take(path: Path) -> Take:
    """Read a take's folder (or its tape). A torn or damaged end is left out and told of.

    Raises StudioError when nothing can be read: no take, no tape, another major version.
    """
    folder, meta, problems = _open(path)
    found = TapeScan()
    ticks: list[Tick] = []
    human_tick: list[int] = []
    for n, (tick, fresh) in enumerate(codec.read_ticks(folder / TAPE, found)):
        ticks.append(tick)
        if fresh:
            human_tick.append(n)
    problems += _troubles(found, meta, len(ticks))
    log_edits = read_edits(folder)
    return Take(
        name=folder.name,
        path=folder,
        meta=meta,
        edits=log_edits.edits,
        ticks=ticks,
        human=_clip(folder.name, ticks, human_tick),
        human_tick=np.array(human_tick, dtype=np.int64),
        complete=found.complete,
        recovered=not found.complete,
        problems=tuple(problems) + log_edits.problems,
    )


def _open(path: Path) -> tuple[Path, dict[str, Any], list[str]]:
    """A take's folder, its meta.json ({} where it is lost), and what is wrong with that."""
    folder = Path(path)
    folder = folder.parent if folder.name == TAPE else folder
    if not folder.is_dir():
        raise StudioError(f"there is no take at {folder}")
    try:
        return folder, read_meta(folder), []
    except MetaLost:
        return folder, {}, [f"{META} is {'damaged' if (folder / META).exists() else 'missing'}"]


def _troubles(found: TapeScan, meta: dict[str, Any], count: int) -> list[str]:
    problems = []
    if found.problem:
        problems.append(found.problem)
    elif not found.complete:
        problems.append("it was not stopped properly")
    asked = meta.get("ticks", count)
    if asked != count:
        problems.append(f"{asked} ticks were recorded, {count} can be read")
    return problems


def iter_ticks(path: Path, found: TapeScan | None = None) -> Iterator[Tick]:
    """The whole ticks of a take's folder, one at a time, in bounded memory; then look at found."""
    yield from iter_tape(Path(path) / TAPE, found)


def iter_tape(tape: Path, found: TapeScan | None = None) -> Iterator[Tick]:
    """The same of a tape, whatever it is called."""
    for tick, _ in codec.read_ticks(tape, found or TapeScan()):
        yield tick


def _clip(name: str, ticks: list[Tick], human_tick: list[int]) -> HumanClip | None:
    poses = [ticks[n].human for n in human_tick]
    poses = [pose for pose in poses if pose is not None]
    if not poses:
        return None
    own = np.array([pose.t for pose in poses])
    used = np.array(human_tick) / a1.CONTROL_HZ
    # A source that was changed or looped runs backwards: then the time of use stands in.
    t = own - own[0] if np.all(np.diff(own) > 0.0) else used - used[0]
    return HumanClip(
        name=name,
        t=t,
        joint_pos_w=np.array([pose.joint_pos_w for pose in poses]),
        confidence=np.array([pose.confidence for pose in poses]),
    )
