"""What listing needs, remembered beside the takes: ten thousand are listed without opening them.

`.index.json` is keyed by each folder's time. It is a cache: losing it costs time only.
"""

import contextlib
import os
import stat
from pathlib import Path

import msgspec

from studio.errors import StudioError
from studio.files import write_whole
from studio.takes.listing import TakeInfo
from studio.takes.record.meta import META, TAPE
from studio.takes.untrusted import read_json

INDEX = ".index.json"
_VERSION = 3
_MOST = 1 << 28
Key = int
Known = dict[str, tuple[Key, TakeInfo]]


class _Index(msgspec.Struct):
    version: int
    takes: Known


_index = msgspec.json.Decoder(_Index)


class Index:
    """Remembers what it read while the file stays the same. Any thread may call it."""

    def __init__(self, root: Path) -> None:
        self._root = root
        self._read: tuple[tuple[int, int, int], Known] | None = None

    def load(self) -> Known:
        """What was remembered; nothing where it cannot be read or is of another version."""
        try:
            about = (self._root / INDEX).stat()
            key = about.st_ino, about.st_size, about.st_mtime_ns
            read = self._read
            if read is not None and read[0] == key:
                return read[1]
            found = read_json(self._root / INDEX, _index, _MOST)
        except (OSError, ValueError):
            return {}
        takes = found.takes if found.version == _VERSION else {}
        self._read = key, takes
        return takes

    def save(self, takes: Known) -> None:
        """Remember it."""
        with contextlib.suppress(OSError):  # a folder that cannot be written is listed slower
            write_whole(
                self._root / INDEX, msgspec.json.encode(_Index(version=_VERSION, takes=takes))
            )


def folders(root: Path, known: Known | None = None) -> dict[str, Key]:
    """Each take's folder with what changes when the take does: the folder's own time (files
    come and go, edits touch it).

    known: takes as they were: while its time is the same, a folder need not be looked into.
    Raises StudioError for a folder that cannot be listed; one that is not there holds none.
    """
    known, out = known or {}, {}
    try:
        with os.scandir(root) as entries:
            for entry in entries:
                if entry.name.startswith("."):
                    continue
                try:
                    about = entry.stat(follow_symlinks=False)
                except FileNotFoundError:
                    continue  # deleted meanwhile
                if not stat.S_ISDIR(about.st_mode):
                    continue
                key = about.st_mtime_ns
                before = known.get(entry.name)
                if (before is not None and before[0] == key) or _holds_take(entry.path):
                    out[entry.name] = key
    except FileNotFoundError:
        return {}
    except OSError as error:
        raise StudioError(f"cannot list {root}: {error.strerror}") from error
    return out


def _holds_take(folder: str) -> bool:
    """Whether it is no folder of the user's own."""
    return any(os.path.exists(os.path.join(folder, file)) for file in (META, TAPE))
