"""Ticks to a take on disk, as they happen: what was flushed survives the death of the process.

A take is a folder: `tape.mcap` (streams human, reference, robot, tick), `meta.json` (what, when,
from which source) and, once somebody edits it, `edits.jsonl`.
"""

import fcntl
import logging
import os
import threading
import time
from datetime import datetime
from pathlib import Path
from typing import Any

from studio import __version__
from studio.errors import StudioError
from studio.robot import a1
from studio.takes.names import check_take, slug
from studio.takes.record import codec
from studio.takes.record.meta import FORMAT_VERSION, TAPE, write_meta
from studio.takes.record.raw_file import RawFile, keep_syncing
from studio.takes.record.tape import Message, TapeWriter, rewrite_chunked
from studio.takes.tick import Tick

log = logging.getLogger(__name__)

LOCK = ".recording.lock"


class Recorder:
    """Writes one take at a time into a sessions folder. The control loop's thread calls it.

    A row costs some tens of microseconds; waiting for the disk (fsync, the compressed rewrite
    after `stop`) happens on other threads. Every failure raises StudioError, ends the take and
    keeps what was recorded; `problem` says so until the next take begins.
    """

    def __init__(self, root: Path) -> None:
        self.root = Path(root)
        self.problem: str | None = None
        self._file: RawFile | None = None
        self._writer: TapeWriter | None = None
        self._lock: int | None = None
        self._finishers: list[threading.Thread] = []
        self._meta: dict[str, Any] = {}
        self._count = self._human_count = 0
        self._states: dict[str, int] = {}
        self._stop_sync = threading.Event()

    @property
    def recording(self) -> str | None:
        """The name of the take being recorded, or None."""
        return self._meta["name"] if self._writer is not None else None

    @property
    def ticks(self) -> int:
        """Of the take being recorded, so far."""
        return self._count

    def start(self, label: str = "", *, name: str | None = None, about: dict | None = None) -> str:
        """Begin a take; its name. `about`: JSON values for meta.json (source, style, …).

        Without a name one is made of date, time and label. Raises StudioError when a take is
        running, the name is taken or unfit, or the folder cannot be written.
        """
        if self._writer is not None:
            raise StudioError(f"take {self.recording} is being recorded: stop it first")
        label = " ".join(str(label).split())[:200]
        now = datetime.now().astimezone()
        if name is None:
            name = "-".join(filter(None, (now.strftime("%Y%m%d-%H%M%S"), slug(label))))
            unique = True
        else:
            check_take(name)
            unique = False
        try:
            self.root.mkdir(parents=True, exist_ok=True)
            self._take_lock()
            folder = self._new_folder(name, unique=unique)
            self._meta = {
                "format": "a1-studio take",
                "format_version": FORMAT_VERSION,
                "name": folder.name,
                "label": label,
                "started": now.isoformat(timespec="milliseconds"),
                "started_ns": max(0, time.time_ns()),  # MCAP counts from 1970
                "control_hz": a1.CONTROL_HZ,
                "studio_version": __version__,
                "about": about or {},
            }
            write_meta(folder, self._meta)
            self._file = RawFile(folder / TAPE)
            self._writer = TapeWriter(self._file, codec.SCHEMAS)  # type: ignore[arg-type]
        except OSError as error:
            self._abandon()
            raise StudioError(
                f"cannot record into {self.root}: {error.strerror}; choose a folder that can be"
                " written (--sessions DIR)"
            ) from error
        self.problem = None
        self._count = self._human_count = 0
        self._states = {}
        self._stop_sync = threading.Event()
        keep_syncing(self._file, self._stop_sync)
        return folder.name

    def append(self, tick: Tick) -> None:
        """Write one control period; flushed to the operating system when this returns.

        Raises StudioError when nothing is recorded, and when it cannot be written: then the take
        is ended, with the ticks before this one.
        """
        if self._writer is None or self._file is None:
            raise StudioError("no take is being recorded: start one first")
        n = self._count
        log_time = self._meta["started_ns"] + round(n * 1e9 / a1.CONTROL_HZ)
        rows = codec.messages(tick, person=tick.human_fresh or self._human_count == 0)
        self._human_count += "human" in rows
        whole = self._file.size
        try:
            for topic, data in rows.items():
                self._writer.write(Message(topic=topic, sequence=n, time=log_time, data=data))
        except OSError as error:
            self._file.cut(whole)
            name, reason = self.recording, error.strerror or str(error)
            self._abandon()
            self.problem = f"recording stopped: {reason}; take {name} keeps its first {n} ticks"
            raise StudioError(self.problem) from error
        self._count += 1
        self._states[tick.state] = self._states.get(tick.state, 0) + 1

    def stop(self) -> dict[str, Any]:
        """End the take: {"name", "ticks"}. Indexing and compressing go on in the background.

        Raises StudioError when nothing is recorded.
        """
        if self._writer is None or self._file is None:
            raise StudioError("no take is being recorded: start one first")
        writer, file, meta = self._writer, self._file, self._meta
        self._writer = self._file = None
        self._stop_sync.set()
        meta = meta | {
            "ticks": self._count,
            "seconds": round(self._count / a1.CONTROL_HZ, 6),
            "human_frames": self._human_count,
            "state_seconds": {k: v / a1.CONTROL_HZ for k, v in self._states.items()},
        }
        finisher = threading.Thread(
            target=self._finish, args=(writer, file, meta), name="finish take"
        )
        self._finishers = [t for t in self._finishers if t.is_alive()] + [finisher]
        finisher.start()
        return {"name": meta["name"], "ticks": self._count}

    def wait(self) -> None:
        """Until every stopped take is indexed and safe on disk."""
        for thread in self._finishers:
            thread.join()

    def close(self) -> None:
        """Stop, wait, and let another studio record into the folder; idempotent."""
        if self._writer is not None:
            self.stop()
        self.wait()
        if self._lock is not None:
            os.close(self._lock)
            self._lock = None

    def _take_lock(self) -> None:
        if self._lock is not None:
            return
        handle = os.open(self.root / LOCK, os.O_RDWR | os.O_CREAT, 0o644)
        try:
            fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except OSError as error:
            os.close(handle)
            raise StudioError(
                f"another studio records into {self.root}: close it, or choose another folder"
                " (--sessions DIR)"
            ) from error
        self._lock = handle

    def _new_folder(self, name: str, *, unique: bool) -> Path:
        for attempt in range(1, 1000):
            folder = self.root / (name if attempt == 1 else f"{name}-{attempt}")
            try:
                folder.mkdir()
                return folder
            except FileExistsError:
                if not unique:
                    raise StudioError(f"a take named {name} exists: choose another name") from None
        raise StudioError(f"there are too many takes named {name}: choose another label")

    def _finish(self, writer: TapeWriter, file: RawFile, meta: dict[str, Any]) -> None:
        folder = self.root / meta["name"]
        try:
            writer.finish()
            write_meta(folder, meta)
            rewrite_chunked(folder / TAPE, codec.SCHEMAS)
            write_meta(folder, meta | {"complete": True})
        except Exception as error:  # whatever it is: this thread's end would be seen by nobody
            why = getattr(error, "strerror", None) or str(error) or type(error).__name__
            self.problem = f"take {folder.name} is kept, but not indexed: {why}"
            expected = isinstance(error, OSError | StudioError)
            log.error("%s", self.problem, exc_info=None if expected else error)
        finally:
            file.close()

    def _abandon(self) -> None:
        self._stop_sync.set()
        if self._file is not None:
            self._file.close()
        self._writer = self._file = None
