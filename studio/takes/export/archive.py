"""A zip of takes to folders of takes: whatever it claims, nothing is written outside of them.

Only members called as a take's files are read, into folders named here; of a member's own path the
name of its folder is kept, made fit.
"""

import shutil
import zipfile
import zlib
from pathlib import Path, PurePosixPath
from typing import IO

from studio.errors import StudioError
from studio.takes.edit.edits import EDITS
from studio.takes.names import fit_name
from studio.takes.record.meta import META, TAPE

FILES = (TAPE, META, EDITS)
MAX_UNPACKED = 8 * 2**30
"""Bytes: forty hours of takes. What unpacks to more is refused, whatever its header says."""
MAX_TAKES = 10_000
SPARE = 1 << 28
"""Bytes that stay free on the disk: somebody may be recording there."""
_BLOCK = 1 << 20


def unpack_takes(file: Path, into: Path, most: int = MAX_UNPACKED) -> list[Path]:
    """The takes in a zip as folders in `into` (which exists), in order of their names.

    Raises StudioError for what is no zip, is damaged or encrypted, holds no take, or too much.
    """
    try:
        with zipfile.ZipFile(file) as archive:
            found = _by_folder(archive)
            if not found:
                raise StudioError(
                    f"{file.name} holds no take: a take is a folder with a {TAPE}, and a zip of"
                    " one or of many is read"
                )
            if len(found) > MAX_TAKES:
                raise StudioError(f"{file.name} holds more than {MAX_TAKES} takes: import fewer")
            left, folders = _room(file, found, into, most), []
            for number, (name, members) in enumerate(found.items()):
                # A folder of its own each: two may be called alike.
                folder = into / str(number) / fit_name(name, fit_name(file.stem))
                folder.mkdir(parents=True)
                for member in members:
                    target = folder / PurePosixPath(member.filename).name
                    with archive.open(member) as source, target.open("wb") as out:
                        left -= _copy(source, out, left)
                folders.append(folder)
            return folders
    except (zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise StudioError(f"{file.name} is no zip that can be read: {error}") from error
    except (RuntimeError, NotImplementedError) as error:  # encrypted; packed in another way
        raise StudioError(f"{file.name} cannot be unpacked here: {error}; zip it anew") from error
    except OSError as error:
        raise StudioError(f"{file.name} was not unpacked: {error.strerror or error}") from error


def _by_folder(archive: zipfile.ZipFile) -> dict[str, list[zipfile.ZipInfo]]:
    """Members of each folder that holds a tape, by the folder's own name where that is unique."""
    folders: dict[PurePosixPath, dict[str, zipfile.ZipInfo]] = {}
    for member in archive.infolist():
        path = PurePosixPath(member.filename.replace("\\", "/"))
        if path.name in FILES and not member.is_dir() and "__MACOSX" not in path.parts:
            folders.setdefault(path.parent, {})[path.name] = member
    out: dict[str, list[zipfile.ZipInfo]] = {}
    for folder in sorted(folders, key=str):
        if TAPE in folders[folder]:
            name = folder.name if folder.name not in out else f"{folder.name}-{len(out)}"
            out[name] = list(folders[folder].values())
    return out


def _room(file: Path, found: dict[str, list[zipfile.ZipInfo]], into: Path, most: int) -> int:
    """Bytes that may be unpacked; StudioError where what the zip claims is more."""
    claimed = sum(member.file_size for members in found.values() for member in members)
    free = (shutil.disk_usage(into).free - SPARE) // 2  # unpacked, then copied
    if claimed > min(most, free):
        why = f", {max(0, free) / 2**30:.1f} GB are free for it" if free < most else ""
        raise StudioError(
            f"{file.name} unpacks to {claimed / 2**30:.1f} GB, more than can be taken in{why}:"
            " import fewer takes"
        )
    return min(most, free)


def _copy(source: IO[bytes], out: IO[bytes], most: int) -> int:
    size = 0
    while block := source.read(_BLOCK):
        size += len(block)
        if size > most:
            raise StudioError("the zip unpacks to more than can be taken in: import fewer takes")
        out.write(block)
    return size
