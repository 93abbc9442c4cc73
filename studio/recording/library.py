"""The sessions folder to a list of takes: found fast, checked, edited, thrown into a bin.

An index (`.index.json`) remembers what listing needs, keyed by each folder's and file's times, so
that ten thousand takes are listed without opening them. It is a cache: losing it costs time only.
"""

import contextlib
import fcntl
import logging
import os
import shutil
from collections.abc import Callable
from dataclasses import asdict, dataclass
from datetime import datetime
from pathlib import Path
from typing import Any

import msgspec

from studio.errors import StudioError
from studio.recording import edits as edit_log
from studio.recording.edits import EDITS, EditLog
from studio.recording.names import RESERVED, take_folder
from studio.recording.recorder import META, TAPE
from studio.recording.take import Take, read_meta, read_take

log = logging.getLogger(__name__)

BIN, INDEX = ".bin", ".index.json"
_INDEX_VERSION = 1
Rows = list[dict[str, Any]]
Key = int
Names = list[str]


@dataclass(frozen=True, kw_only=True)
class TakeInfo:
    """A line of the list. complete: it was stopped properly; recovered: it was not, what is left
    of it is there; recording: it is being written now. Edits (label, keep, score, trim, lag) are
    the present ones."""

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
    note: str | None = None
    undoable: int = 0
    redoable: int = 0
    complete: bool = False
    recovered: bool = False
    recording: bool = False
    problems: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values, as contract.md's GET /api/takes gives them."""
        return asdict(self)


class SessionLibrary:
    """The takes in one folder. Methods may be called from any thread; each reads the disk anew."""

    def __init__(self, root: Path) -> None:
        self.root = Path(root)

    def list(self) -> list[TakeInfo]:
        """Every take, newest name last. An unreadable one is listed with its problem."""
        old = self._load_index()
        new: dict[str, tuple[Key, TakeInfo]] = {}
        for name, key in self._folders().items():
            known = old.get(name)
            if known is not None and known[0] == key and not known[1].recording:
                new[name] = known
            else:
                new[name] = (key, self._examine(self.root / name))
        if new.keys() != old.keys() or any(new[name] is not old[name] for name in new):
            self._save_index(new)
        return [new[name][1] for name in sorted(new)]

    def info(self, name: str) -> TakeInfo:
        """One take's line; StudioError for an unknown name."""
        return self._examine(self.folder(name))

    def folder(self, name: str) -> Path:
        """The folder of an existing take; StudioError for an unfit or unknown name."""
        folder = take_folder(self.root, name)
        if not folder.is_dir() or not ((folder / META).exists() or (folder / TAPE).exists()):
            names = self._names()
            known = ", ".join(names[-8:]) or "none yet"
            more = f" and {len(names) - 8} more" if len(names) > 8 else ""
            raise StudioError(f"unknown take {name!r} in {self.root}; known: {known}{more}")
        return folder

    def read(self, name: str) -> Take:
        """The whole take."""
        return read_take(self.folder(name))

    def verify(self, name: str | None = None) -> Rows:
        """Read tapes whole: name, ticks, seconds, complete, recovered, readable, problems."""
        names = self._names() if name is None else [self.folder(name).name]
        return [_verified(self.root / n) for n in names]

    def edit(self, name: str, **changes: Any) -> TakeInfo:
        """Set label, note, trim, lag, keep or score; refuses a trim outside the take."""
        folder = self.folder(name)
        trim = changes.get("trim")
        if isinstance(trim, list | tuple) and len(trim) == 2:
            seconds = self._examine(folder).seconds
            if isinstance(trim[1], int | float) and trim[1] > seconds + 1e-6:
                raise StudioError(f"a trim must end within the take's {seconds:.3f} s")
        edit_log.edit(folder, **changes)
        return self._examine(folder)

    def undo(self, name: str) -> TakeInfo:
        """Take the last edit back; a split's other half goes to the bin."""
        return self._step(name, edit_log.undo)

    def redo(self, name: str) -> TakeInfo:
        """Do the last edit taken back again; a split's other half comes back from the bin."""
        return self._step(name, edit_log.redo)

    def _step(self, name: str, step: Callable[[Path], EditLog]) -> TakeInfo:
        folder = self.folder(name)
        before = set(edit_log.read_edits(folder).edits.splits or ())
        after = set(step(folder).edits.splits or ())
        with contextlib.suppress(StudioError):  # deleted or restored by hand meanwhile
            for half in before - after:
                self.delete(half)
            for half in after - before:
                self.restore(half)
        return self.info(name)

    def split(self, name: str, at: float) -> tuple[TakeInfo, TakeInfo]:
        """Cut a take in two at `at` s: it ends there, a second take of the same tape goes on.

        Both keep label, note, lag, warp and cuts. Undo of the first joins them again. Raises
        StudioError when `at` does not leave something on both sides.
        """
        folder = self.folder(name)
        if _is_recording(folder):
            raise StudioError(f"take {name} is being recorded: stop it first")
        edits = edit_log.read_edits(folder).edits
        start, end = edits.trim or (0.0, self._examine(folder).seconds)
        if not start < at < end:
            raise StudioError(f"a split must lie within the take: {start:g} < at < {end:g} s")
        number = 2
        while (self.root / f"{name}-{number}").exists():
            number += 1
        other = self.add(folder, f"{name}-{number}", link=True)
        try:
            # The other half begins with no history: its edits so far are the whole take's.
            (self.root / other / EDITS).unlink(missing_ok=True)
            kept = {k: v for k, v in asdict(edits).items() if v is not None}
            kept = {k: v for k, v in kept.items() if k not in ("splits", "score", "keep")}
            edit_log.record(self.root / other, **kept | {"trim": (at, end)})
        except OSError as error:
            raise StudioError(f"take {name} was not split: {error.strerror}") from error
        splits = (*(edits.splits or ()), other)
        return self.edit(name, trim=(start, at), splits=splits), self.info(other)

    def delete(self, name: str) -> Path:
        """Move a take into the bin (`.bin` in the folder); where it lies now."""
        folder = self.folder(name)
        if _is_recording(folder):
            raise StudioError(f"take {name} is being recorded: stop it first")
        target = self.root / BIN / f"{name}.{datetime.now():%Y%m%d-%H%M%S-%f}"
        try:
            target.parent.mkdir(exist_ok=True)
            folder.rename(target)
        except OSError as error:
            raise StudioError(f"take {name} was not deleted: {error.strerror}") from error
        return target

    def deleted(self) -> Names:
        """Names of the takes in the bin, the last one deleted last."""
        found = sorted(
            (stamp, name)
            for path in (self.root / BIN).glob("*")
            for name, _, stamp in [path.name.partition(".")]
            if stamp and path.is_dir()
        )
        return list(dict.fromkeys(name for _, name in found))

    def restore(self, name: str) -> TakeInfo:
        """Bring the take of this name that was deleted last back from the bin."""
        target = take_folder(self.root, name)
        found = sorted((self.root / BIN).glob(f"{name}.*"))
        if not found:
            known = ", ".join(self.deleted()[-8:]) or "nothing"
            raise StudioError(f"no take {name!r} in the bin; it holds: {known}")
        if target.exists():
            raise StudioError(f"a take named {name} exists: delete that one first")
        try:
            found[-1].rename(target)
            os.utime(target)
        except OSError as error:
            raise StudioError(f"take {name} was not restored: {error.strerror}") from error
        return self.info(name)

    def add(self, folder: Path, name: str | None = None, *, link: bool = False) -> str:
        """Copy a take's folder from elsewhere into the library; its name here.

        link: share the tape with the original, which is never written to again.
        """
        source = Path(folder)
        if not link:
            read_take(source)  # refuses what is no take, or of another version
        name = name or source.name
        target = take_folder(self.root, name)
        if target.exists():
            raise StudioError(f"a take named {name} exists: give another name")
        files = [source / f for f in (META, TAPE, EDITS) if (source / f).is_file()]
        temporary = self.root / f".import-{os.getpid()}-{name}"
        try:
            temporary.mkdir(parents=True)
            for file in files:
                if link and file.name == TAPE:
                    _share(file, temporary / file.name)
                else:
                    shutil.copyfile(file, temporary / file.name)
            temporary.rename(target)
        except OSError as error:
            shutil.rmtree(temporary, ignore_errors=True)
            raise StudioError(f"{source.name} was not imported: {error.strerror}") from error
        return name

    def _names(self) -> Names:
        return sorted(self._folders())

    def _folders(self) -> dict[str, Key]:
        """Each take's folder with what changes when the take does: the folder's own time (files
        come and go, edits touch it)."""
        out: dict[str, Key] = {}
        try:
            with os.scandir(self.root) as entries:
                for entry in entries:
                    if entry.name.startswith(".") or entry.name in RESERVED:
                        continue
                    if not entry.is_dir(follow_symlinks=False):
                        continue
                    folder = Path(entry.path)
                    if not ((folder / META).exists() or (folder / TAPE).exists()):
                        continue  # no take: a folder of the user's own
                    with contextlib.suppress(FileNotFoundError):  # deleted meanwhile
                        out[entry.name] = entry.stat(follow_symlinks=False).st_mtime_ns
        except FileNotFoundError:
            return {}
        except OSError as error:
            raise StudioError(f"cannot list {self.root}: {error.strerror}") from error
        return out

    def _examine(self, folder: Path) -> TakeInfo:
        edits = edit_log.read_edits(folder)
        recording = _is_recording(folder)
        try:
            meta = read_meta(folder)
        except StudioError as error:
            if not (folder / TAPE).exists():
                return TakeInfo(name=folder.name, problems=(str(error),))
            meta = {}
            if (folder / META).exists():
                with contextlib.suppress(msgspec.DecodeError, OSError):
                    # Of another version: not ours to read further.
                    msgspec.json.decode((folder / META).read_bytes())
                    return TakeInfo(name=folder.name, problems=(str(error),))
        if "ticks" in meta or recording:
            return _info(folder, meta, edits, complete="ticks" in meta, recording=recording)
        try:
            take = read_take(folder)
        except StudioError as error:
            return _info(folder, meta, edits, problems=(str(error),))
        meta = meta | {"ticks": len(take), "seconds": take.seconds}
        return _info(
            folder, meta, edits, complete=take.complete, recovered=take.recovered,
            problems=take.problems[: len(take.problems) - len(edits.problems)],
        )  # fmt: skip

    def _load_index(self) -> dict[str, tuple[Key, TakeInfo]]:
        try:
            index = msgspec.json.decode((self.root / INDEX).read_bytes(), type=_Index)
        except (OSError, msgspec.DecodeError):
            return {}
        return index.takes if index.version == _INDEX_VERSION else {}

    def _save_index(self, takes: dict[str, tuple[Key, TakeInfo]]) -> None:
        temporary = self.root / f"{INDEX}.{os.getpid()}.tmp"
        with contextlib.suppress(OSError):  # a folder that cannot be written is listed slower
            temporary.write_bytes(msgspec.json.encode(_Index(version=_INDEX_VERSION, takes=takes)))
            temporary.replace(self.root / INDEX)


def _share(file: Path, target: Path) -> None:
    try:
        target.hardlink_to(file)
    except OSError:  # a file system without links
        shutil.copyfile(file, target)


class _Index(msgspec.Struct):
    version: int
    takes: dict[str, tuple[Key, TakeInfo]]


def _is_recording(folder: Path) -> bool:
    """Whether a living process holds the tape (the lock dies with it)."""
    try:
        handle = os.open(folder / TAPE, os.O_RDONLY)
    except OSError:
        return False
    try:
        fcntl.flock(handle, fcntl.LOCK_SH | fcntl.LOCK_NB)
    except OSError:
        return True
    finally:
        os.close(handle)
    return False


def _info(
    folder: Path,
    meta: dict[str, Any],
    log: EditLog,
    *,
    complete: bool = False,
    recovered: bool = False,
    recording: bool = False,
    problems: tuple[str, ...] = (),
) -> TakeInfo:
    edits = log.edits
    about = meta.get("about") or {}
    return TakeInfo(
        name=folder.name,
        label=meta.get("label", "") if edits.label is None else edits.label,
        started=meta.get("started", ""),
        source=str(about.get("source", "")),
        seconds=round(float(meta.get("seconds", 0.0)), 6),
        ticks=int(meta.get("ticks", 0)),
        score=edits.score,
        kept=edits.keep,
        trim=edits.trim,
        lag=edits.lag,
        note=edits.note,
        undoable=log.undoable,
        redoable=log.redoable,
        complete=complete,
        recovered=recovered,
        recording=recording,
        problems=problems + log.problems,
    )


def _verified(folder: Path) -> dict[str, Any]:
    out: dict[str, Any] = {"name": folder.name, "ticks": 0, "seconds": 0.0}
    out |= {"complete": False, "recovered": False, "readable": False}
    try:
        take = read_take(folder)
    except StudioError as error:
        return out | {"problems": [str(error)]}
    return out | {
        "ticks": len(take),
        "seconds": round(take.seconds, 6),
        "complete": take.complete,
        "recovered": take.recovered,
        "readable": True,
        "problems": list(take.problems),
    }
