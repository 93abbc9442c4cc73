"""The sessions folder to a list of takes: found fast, checked, edited, thrown into a bin."""

import contextlib
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.takes import bin, index
from studio.takes.edit import edits as edit_log
from studio.takes.edit.edits import EDITS, EditLog
from studio.takes.export.adding import add_take
from studio.takes.listing import TakeInfo, examine, is_recording, verified
from studio.takes.names import take_folder
from studio.takes.record.meta import META, TAPE
from studio.takes.take import Take, read_take, survey_take

Rows = list[dict[str, Any]]
Names = list[str]


class SessionLibrary:
    """The takes in one folder. Methods may be called from any thread; each reads the disk anew."""

    def __init__(self, root: Path) -> None:
        self.root = Path(root)
        self._index = index.Index(self.root)

    def list(self) -> list[TakeInfo]:
        """Every take, newest name last. An unreadable one is listed with its problem."""
        old = self._index.load()
        new: index.Known = {}
        for name, key in index.folders(self.root, old).items():
            known = old.get(name)
            if known is not None and known[0] == key and not known[1].recording:
                new[name] = known
            else:
                new[name] = (key, examine(self.root / name))
        if len(new) != len(old) or any(new[name] is not old.get(name) for name in new):
            self._index.save(new)
        return [new[name][1] for name in sorted(new)]

    def info(self, name: str) -> TakeInfo:
        """One take's line; StudioError for an unknown name."""
        return examine(self.folder(name))

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
        return [verified(self.root / n) for n in names]

    def edit(self, name: str, **changes: Any) -> TakeInfo:
        """Set label, note, trim, lag, keep or score; refuses a trim outside the take.

        An end up to half a millisecond beyond the take's is its end: 200 ticks last 6.6667 s, which
        whoever counts in milliseconds calls 6.667."""
        folder = self.folder(name)
        trim = changes.get("trim")
        if isinstance(trim, list | tuple) and len(trim) == 2:
            # What was stopped a moment ago may not say yet how long it is.
            seconds = (survey_take if is_recording(folder) else examine)(folder).seconds
            if isinstance(trim[1], int | float) and trim[1] > seconds:
                if trim[1] > seconds + 0.5e-3:
                    raise StudioError(f"a trim must end within the take's {seconds:.3f} s")
                changes["trim"] = [trim[0], seconds]
        edit_log.edit(folder, **changes)
        return examine(folder)

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
        if is_recording(folder):
            raise StudioError(f"take {name} is being recorded: stop it first")
        edits = edit_log.read_edits(folder).edits
        start, end = edits.trim or (0.0, examine(folder).seconds)
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
        """Move a take into the bin (`.bin` in the folder); where it lies now.

        Raises StudioError while it is being recorded.
        """
        folder = self.folder(name)
        if is_recording(folder):
            raise StudioError(f"take {name} is being recorded: stop it first")
        return bin.throw(self.root, folder)

    def deleted(self) -> Names:
        """Names of the takes in the bin, the last one deleted last."""
        return bin.names(self.root)

    def restore(self, name: str) -> TakeInfo:
        """Bring the take of this name that was deleted last back from the bin."""
        bin.bring_back(self.root, name)
        return self.info(name)

    def add(self, folder: Path, name: str | None = None, *, link: bool = False) -> str:
        """Copy a take's folder from elsewhere into the library; its name here.

        link: share the tape with the original, which is never written to again.
        """
        return add_take(self.root, folder, name, link=link)

    def _names(self) -> Names:
        return sorted(index.folders(self.root))
