"""What listing needs, remembered beside the takes: ten thousand are listed without opening them.

`.index.json` is keyed by each folder's time. It is a cache: losing it costs time only.
"""

import contextlib
import os
from pathlib import Path

import msgspec

from studio.errors import StudioError
from studio.recording.listing import TakeInfo
from studio.recording.names import RESERVED
from studio.recording.recorder import META, TAPE

INDEX = ".index.json"
_VERSION = 1
Key = int


class _Index(msgspec.Struct):
    version: int
    takes: dict[str, tuple[Key, TakeInfo]]


def load(root: Path) -> dict[str, tuple[Key, TakeInfo]]:
    """What was remembered; nothing where it cannot be read or is of another version."""
    try:
        index = msgspec.json.decode((root / INDEX).read_bytes(), type=_Index)
    except (OSError, msgspec.DecodeError):
        return {}
    return index.takes if index.version == _VERSION else {}


def save(root: Path, takes: dict[str, tuple[Key, TakeInfo]]) -> None:
    """Remember it."""
    temporary = root / f"{INDEX}.{os.getpid()}.tmp"
    with contextlib.suppress(OSError):  # a folder that cannot be written is listed slower
        temporary.write_bytes(msgspec.json.encode(_Index(version=_VERSION, takes=takes)))
        temporary.replace(root / INDEX)


def folders(root: Path) -> dict[str, Key]:
    """Each take's folder with what changes when the take does: the folder's own time (files
    come and go, edits touch it)."""
    out: dict[str, Key] = {}
    try:
        with os.scandir(root) as entries:
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
        raise StudioError(f"cannot list {root}: {error.strerror}") from error
    return out
