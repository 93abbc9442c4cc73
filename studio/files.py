"""What lies on disk: regular files, written whole or not at all, known by what they are made of;
temporary folders that go with their process."""

import errno
import fcntl
import hashlib
import io
import os
import shutil
import stat
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from glob import escape
from pathlib import Path
from typing import BinaryIO

from studio.errors import StudioError

STUDIO = Path(__file__).resolve().parent
FULL = (errno.ENOSPC, errno.EDQUOT, errno.EFBIG)
"""Numbers of an OSError where nothing more can be written: no fault of ours."""
BUFFER = 65_536
"""Bytes that can be looked at ahead (`peek`)."""
_LOCK = ".lock"
_YOUNG_S = 60.0  # a folder without a locked file may be one that is just being made


@contextmanager
def whole(path: Path, *, parents: bool = False) -> Iterator[Path]:
    """A path beside `path` for a file or a folder, which takes its place when the block ends.

    Whatever ends the block early, nothing is left of it and `path` is as it was; a folder that was
    there is replaced. What a killed process left goes with the next write. parents: make the folder
    around it. Raises OSError.
    """
    if parents:
        path.parent.mkdir(parents=True, exist_ok=True)
    for left in path.parent.glob(f".{escape(path.name)}.*.tmp"):
        if not _alive(left):
            _remove(left)
    # Two processes or threads that write the same file do not write into each other.
    mine = f"{os.getpid()}-{threading.get_ident()}"
    scratch = path.with_name(f".{path.name}.{mine}.tmp")
    try:
        yield scratch
        if scratch.is_dir() and path.is_dir():
            shutil.rmtree(path)
        scratch.replace(path)
    finally:
        _remove(scratch)


def copy_whole(source: Path, target: Path) -> None:
    """A copy of a file, whole or not at all, its folder made where need be. Raises OSError."""
    with whole(target, parents=True) as scratch:
        shutil.copy(source, scratch)


def _alive(scratch: Path) -> bool:
    """Whether the process that writes it is there, as far as can be told."""
    number = scratch.name.split(".")[-2].partition("-")[0]
    try:
        os.kill(int(number), 0)
    except ProcessLookupError:
        return False
    except (ValueError, OverflowError, OSError):
        return True
    return True


def _remove(scratch: Path) -> None:
    if scratch.is_dir():
        shutil.rmtree(scratch, ignore_errors=True)
    with suppress(OSError):
        scratch.unlink(missing_ok=True)


def sweep_writes(folder: Path) -> None:
    """Remove what killed processes left of writing into a folder."""
    for left in folder.glob(".*.tmp"):
        if not _alive(left):
            _remove(left)


def write_whole(path: Path, data: bytes | str, *, parents: bool = False, mode: int = 0o666) -> None:
    """Replace a file by these bytes, or this text in UTF-8, whole or not at all. Raises OSError.

    mode: who may do what with it, from its first byte on, less the process's umask.
    """
    with whole(path, parents=parents) as scratch:
        scratch.unlink(missing_ok=True)  # of a killed process that had our number
        with open(os.open(scratch, os.O_WRONLY | os.O_CREAT | os.O_EXCL, mode), "wb") as file:
            file.write(data.encode() if isinstance(data, str) else data)


@contextmanager
def scratch_folder(prefix: str, parent: Path | None = None) -> Iterator[Path]:
    """A new folder in `parent` (the system's own place by default), gone afterwards.

    It holds a file that this process keeps locked; the system lets go of it when the process ends,
    however it ends, and `sweep` then knows that the folder is nobody's.
    """
    folder = Path(tempfile.mkdtemp(prefix=prefix, dir=parent))
    handle = os.open(folder / _LOCK, os.O_RDWR | os.O_CREAT, 0o600)
    try:
        fcntl.flock(handle, fcntl.LOCK_EX | fcntl.LOCK_NB)
        yield folder
    finally:
        shutil.rmtree(folder, ignore_errors=True)
        os.close(handle)


def sweep(prefix: str, parent: Path | None = None) -> list[str]:
    """Remove the folders of processes that are no more; their names."""
    gone = []
    for folder in (parent or Path(tempfile.gettempdir())).glob(f"{prefix}*"):
        if _abandoned(folder):
            shutil.rmtree(folder, ignore_errors=True)
            gone.append(folder.name)
    return gone


def _abandoned(folder: Path) -> bool:
    try:
        about = folder.lstat()
        if not stat.S_ISDIR(about.st_mode) or about.st_uid != os.getuid():
            return False
        if not (folder / _LOCK).exists():
            return time.time() - about.st_mtime > _YOUNG_S
        with (folder / _LOCK).open("rb") as file:
            fcntl.flock(file, fcntl.LOCK_EX | fcntl.LOCK_NB)
        return True
    except OSError:  # somebody holds it, or has just removed it
        return False


def fingerprint(*parts: str | Path) -> str:
    """(64 hex digits) changes with what is made from these parts, and with nothing else.

    A str names our own code, below studio/: a room ("reference": every file in it) or one file
    without its suffix ("rl/bank"). A Path is any other file. Raises OSError for what is not there.
    """
    digest = hashlib.sha256()
    for part in parts:
        for file in _code(part) if isinstance(part, str) else [part]:
            name = file.relative_to(STUDIO).as_posix() if STUDIO in file.parents else file.name
            digest.update(f"{name}\0{hashlib.sha256(file.read_bytes()).hexdigest()}\n".encode())
    return digest.hexdigest()


def _code(name: str) -> list[Path]:
    room = STUDIO / name
    return sorted(room.rglob("*.py")) if room.is_dir() else [room.with_suffix(".py")]


def opened(path: Path) -> io.BufferedReader:
    """A regular file of ours opened for reading bytes. OSError for what is not there, and for a
    device or a pipe, which would keep whoever opens it until somebody writes."""
    descriptor = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    if not stat.S_ISREG(os.fstat(descriptor).st_mode):
        os.close(descriptor)
        raise OSError(errno.EINVAL, "it is no regular file", str(path))
    return os.fdopen(descriptor, "rb")


def open_regular(path: str | Path, max_bytes: int) -> BinaryIO:
    """A regular file opened for reading bytes, up to the size that it has now.

    A device or a pipe could hold the reader for ever, so it is refused before it is opened, as is
    more than max_bytes. Raises StudioError for these, and for what is not there.
    """
    path = Path(path)
    try:
        _check(path, os.stat(path), max_bytes)
        # Not blocking: between the two looks a pipe may have taken the file's place.
        descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    except (OSError, ValueError) as error:  # ValueError: a NUL in the path
        raise StudioError(f"cannot read {path}: {error}; give a file") from error
    try:
        about = os.fstat(descriptor)
        _check(path, about, max_bytes)
        raw = _UpTo(os.fdopen(descriptor, "rb", 0), about.st_size)  # type: ignore[arg-type]
        return io.BufferedReader(raw, BUFFER)  # type: ignore[return-value]
    except BaseException:
        os.close(descriptor)
        raise


def _check(path: Path, about: os.stat_result, max_bytes: int) -> None:
    if not stat.S_ISREG(about.st_mode):
        raise StudioError(f"cannot read {path}: it is no regular file; give a file")
    if about.st_size > max_bytes:
        raise StudioError(
            f"cannot read {path}: {about.st_size / 2**20:.0f} MB, and at most "
            f"{max_bytes / 2**20:g} MB are read; cut it into shorter ones"
        )


class _UpTo(io.RawIOBase):
    """The first bytes of a file: one that grows while it is read, or lies about its size, ends."""

    def __init__(self, file: io.FileIO, size: int) -> None:
        self._file, self._left = file, size

    def readable(self) -> bool:
        return True

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        got = self._file.readinto(memoryview(buffer)[: self._left]) or 0
        self._left -= got
        return got

    def close(self) -> None:
        self._file.close()
        super().close()
