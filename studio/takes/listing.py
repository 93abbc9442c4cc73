"""A take's folder to its line in the list."""

import fcntl
import logging
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.files import opened
from studio.takes.columns import known_problem
from studio.takes.edit import edits as edit_log
from studio.takes.edit.edits import EditLog
from studio.takes.names import take_folder
from studio.takes.record.meta import TAPE, MetaLost, read_meta
from studio.takes.take import survey_take

log = logging.getLogger(__name__)

_EMPTY = "it holds no tick that could be read"


@dataclass(frozen=True, kw_only=True)
class TakeInfo:
    """A line of the list. complete: it was stopped properly; recovered: it was not, what is left
    of it is there; recording: it is being written now; damaged: why it, or a part of it, cannot be
    used, or "". Edits (label, keep, score, trim, lag) are
    the present ones; warped: time is bent too."""

    name: str
    label: str = ""
    started: str = ""
    source: str = ""
    seconds: float = 0.0
    ticks: int = 0
    score: float | None = None
    kept: bool | None = None
    trim: tuple[float, float] | None = None
    lag: float | None = None
    warped: bool = False
    note: str | None = None
    undoable: int = 0
    redoable: int = 0
    complete: bool = False
    recovered: bool = False
    recording: bool = False
    damaged: str = ""
    problems: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values, as docs/contract.md's GET /api/takes gives them."""
        return {name: getattr(self, name) for name in self.__dataclass_fields__}  # asdict copies


def examine(folder: Path, name: str | None = None) -> TakeInfo:
    """A take's line, its tape read only where nothing else says what is on it. Never raises.

    name: the take's, where its folder is called otherwise.
    """
    name = folder.name if name is None else name
    try:
        take_folder(folder.parent, name)
        return _examine(folder, name)
    except StudioError as error:
        return TakeInfo(name=name, damaged=str(error), problems=(str(error),))
    except Exception as error:  # whatever is wrong with one take, the others are listed
        log.exception("take %s cannot be looked at", name)
        why = f"take {name} cannot be read: {error}"
        return TakeInfo(name=name, damaged=why, problems=(why,))


def _examine(folder: Path, name: str) -> TakeInfo:
    edits = edit_log.read_edits(folder)
    recording = is_recording(folder)
    try:
        meta = read_meta(folder)
    except MetaLost:
        if not (folder / TAPE).exists():
            raise
        meta = {}
    if "ticks" in meta or recording:
        # What is wrong with its tape is known once somebody has looked into it.
        problem = "" if recording else known_problem(folder) or ("" if meta["ticks"] else _EMPTY)
        return _info(
            name, meta, edits, complete="ticks" in meta and not problem, recording=recording,
            damaged=problem, problems=(problem,) if problem else (),
        )  # fmt: skip
    take = survey_take(folder)
    meta = meta | {"ticks": take.ticks, "seconds": take.seconds}
    return _info(
        name, meta, edits, complete=take.complete, recovered=not take.complete,
        damaged="" if take.ticks else _EMPTY, problems=take.problems,
    )  # fmt: skip


def is_recording(folder: Path) -> bool:
    """Whether a living process holds the tape (the lock dies with it)."""
    try:
        file = opened(folder / TAPE)
    except OSError:
        return False
    with file:
        try:
            fcntl.flock(file, fcntl.LOCK_SH | fcntl.LOCK_NB)
        except OSError:
            return True
    return False


def _info(
    name: str,
    meta: dict[str, Any],
    edited: EditLog,
    *,
    complete: bool = False,
    recovered: bool = False,
    recording: bool = False,
    damaged: str = "",
    problems: tuple[str, ...] = (),
) -> TakeInfo:
    edits = edited.edits
    about = meta.get("about") or {}
    return TakeInfo(
        name=name,
        label=meta.get("label", "") if edits.label is None else edits.label,
        started=meta.get("started", ""),
        source=str(about.get("source", "")),
        seconds=round(float(meta.get("seconds", 0.0)), 6),
        ticks=int(meta.get("ticks", 0)),
        score=edits.score,
        kept=edits.keep,
        trim=edits.trim,
        lag=edits.lag,
        warped=bool(edits.warp),
        note=edits.note,
        undoable=edited.undoable,
        redoable=edited.redoable,
        complete=complete,
        recovered=recovered,
        recording=recording,
        damaged=damaged or ("" if edited.readable else edited.problems[0]),
        problems=problems + edited.problems,
    )


def verified(folder: Path) -> dict[str, Any]:
    """What reading a take's tape whole says of it."""
    out: dict[str, Any] = {"name": folder.name, "ticks": 0, "seconds": 0.0}
    out |= {"complete": False, "recovered": False, "readable": False}
    try:
        take = survey_take(folder)
    except StudioError as error:
        return out | {"problems": [str(error)]}
    return out | {
        "ticks": take.ticks,
        "seconds": round(take.seconds, 6),
        "complete": take.complete,
        "recovered": not take.complete,
        "readable": True,
        "problems": [*take.problems, *edit_log.read_edits(folder).problems],
    }
