"""A file that only grows: each write reaches the system at once, and the disk within a second."""

import contextlib
import fcntl
import logging
import os
import threading
from pathlib import Path

log = logging.getLogger(__name__)

SYNC_PERIOD = 1.0
"""s between fsyncs on the side thread: what a power failure may cost."""


class RawFile:
    """An append-only file without a buffer of its own: each write reaches the system at once."""

    def __init__(self, path: Path) -> None:
        self._fd = os.open(path, os.O_WRONLY | os.O_CREAT | os.O_EXCL, 0o644)
        fcntl.flock(self._fd, fcntl.LOCK_EX)  # how a library tells a running take from a dead one
        self.size = 0
        self.closed = False

    def write(self, data: bytes) -> int:
        rest = memoryview(data)
        while rest:
            written = os.write(self._fd, rest)
            self.size += written
            rest = rest[written:]
        return len(data)

    def cut(self, size: int) -> None:
        """Drop what was half written (works on a full disk too)."""
        with contextlib.suppress(OSError):
            os.ftruncate(self._fd, size)

    def tell(self) -> int:
        return self.size

    def fileno(self) -> int:
        return self._fd

    def flush(self) -> None:
        pass

    def close(self) -> None:
        if not self.closed:
            self.closed = True
            with contextlib.suppress(OSError):
                os.close(self._fd)


def keep_syncing(file: RawFile, stop: threading.Event) -> None:
    """Force what is written to disk now and then, on a thread and a descriptor of its own."""
    handle = os.dup(file.fileno())
    threading.Thread(
        target=_sync_forever, args=(handle, stop), name="sync take", daemon=True
    ).start()


def _sync_forever(handle: int, stop: threading.Event) -> None:
    """fsync a descriptor of its own now and then, until told to stop; closes it."""
    try:
        while not stop.wait(SYNC_PERIOD):
            os.fsync(handle)
    except OSError as error:
        log.warning("the take could not be forced to disk: %s", error.strerror)
    finally:
        os.close(handle)
