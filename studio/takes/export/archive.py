"""A zip of takes, or of a LeRobotDataset of ours, to folders: nothing is written outside of them,
whatever it claims.

Only members called as a take's or a data set's files are read, into folders named here; of a
member's own path the name of its folder is kept, made fit. A member is looked at before it is
unpacked: what is no tape, or claims more than files of ours do, is refused at once.
"""

import io
import re
import shutil
import zipfile
import zlib
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path, PurePosixPath
from typing import Any

from studio.errors import StudioError
from studio.files import scratch_folder
from studio.takes.edit.edits import EDITS, MOST_EDITS
from studio.takes.export.adding import SCRATCH, add_all
from studio.takes.export.lerobot_meta import INFO, ORIGIN, TASKS
from studio.takes.export.lerobot_read import import_lerobot
from studio.takes.names import fit_name
from studio.takes.record.meta import META, TAPE
from studio.takes.record.tape import MAGIC
from studio.takes.untrusted import MOST_JSON, MOST_UNPACKED, may_unpack

FILES = (TAPE, META, EDITS)
MAX_TAKES = 10_000
SPARE = 1 << 28
"""Bytes that stay free on the disk: somebody may be recording there."""
MOST_LISTED = 8 << 20
"""Bytes of a zip's list of members: MAX_TAKES take 4 MB."""
_BLOCK = 1 << 20
_DATA = re.compile(r"data/chunk-\d{3}/file-\d{3}\.parquet")
_LARGEST = {META: MOST_JSON, EDITS: MOST_EDITS}


def import_zip(root: Path, file: Path) -> dict[str, Any]:
    """Takes in a zip, or the episodes of a LeRobotDataset of ours in one, to takes in `root`:
    {"takes": names here, "refused": {name: why}}. StudioError for what holds none."""
    try:
        root.mkdir(parents=True, exist_ok=True)
        with scratch_folder(SCRATCH, root) as scratch:
            dataset = unpack_lerobot(file, scratch)
            if dataset is not None:
                return import_lerobot(root, dataset)
            taken, refused = add_all(root, unpack_takes(file, scratch))
            return {"takes": taken, "refused": refused}
    except OSError as error:
        raise StudioError(f"{file.name} was not imported: {error.strerror}") from error


def unpack_takes(file: Path, into: Path, most: int = MOST_UNPACKED) -> list[Path]:
    """The takes in a zip as folders in `into` (which exists), in order of their names.

    Raises StudioError for what is no zip, is damaged or encrypted, holds no take, or too much.
    """
    with _opened(file) as archive:
        found = _by_folder(archive)
        if not found:
            raise StudioError(
                f"{file.name} holds no take: a take is a folder with a {TAPE}, and a zip of"
                " one or of many, or of a LeRobotDataset of ours, is read"
            )
        if len(found) > MAX_TAKES:
            raise StudioError(f"{file.name} holds more than {MAX_TAKES} takes: import fewer")
        members = [member for folder in found.values() for member in folder]
        left, folders = _room(file, members, into, most), []
        for number, (name, members) in enumerate(found.items()):
            # A folder of its own each: two may be called alike.
            folder = into / str(number) / fit_name(name, fit_name(file.stem))
            folder.mkdir(parents=True)
            for member in members:
                last = PurePosixPath(member.filename).name
                left -= _copy(archive, member, folder / last, left, MAGIC if last == TAPE else b"")
            folders.append(folder)
        return folders


def unpack_lerobot(file: Path, into: Path, most: int = MOST_UNPACKED) -> Path | None:
    """The LeRobotDataset in a zip as a folder in `into`; None where it holds none. Errors as
    `unpack_takes`."""
    with _opened(file) as archive:
        members = {_path(member): member for member in archive.infolist() if not member.is_dir()}
        roots = [path.parent.parent for path in members if str(path).endswith(INFO)]
        if not roots:
            return None
        root, name = min(roots, key=lambda path: len(path.parts)), fit_name(file.stem)
        wanted = {
            str(path.relative_to(root)): member
            for path, member in members.items()
            if path.is_relative_to(root)
        }
        wanted = {
            path: member
            for path, member in wanted.items()
            if path in (INFO, TASKS, ORIGIN) or _DATA.fullmatch(path)
        }
        left = _room(file, list(wanted.values()), into, most)
        for path, member in wanted.items():
            (into / name / path).parent.mkdir(parents=True, exist_ok=True)
            left -= _copy(archive, member, into / name / path, left)
        return into / name


class _ShortList(io.FileIO):
    """A zip whose list of members is short: zipfile reads it at once, and makes an object of each
    entry. Members are read in blocks."""

    def read(self, size: int | None = -1, /) -> bytes:
        """As of any file; BadZipFile where more is asked for at once than a list may have."""
        if size is not None and size > MOST_LISTED:
            raise zipfile.BadZipFile("it lists more members than takes have")
        return super().read(size)


@contextmanager
def _opened(file: Path) -> Iterator[zipfile.ZipFile]:
    try:
        with _ShortList(file) as data, zipfile.ZipFile(data) as archive:
            yield archive
    except (zipfile.BadZipFile, zlib.error, EOFError) as error:
        raise StudioError(f"{file.name} is no zip that can be read: {error}") from error
    except (RuntimeError, NotImplementedError) as error:  # encrypted; packed in another way
        raise StudioError(f"{file.name} cannot be unpacked here: {error}; zip it anew") from error
    except OSError as error:
        raise StudioError(f"{file.name} was not unpacked: {error.strerror or error}") from error


def _path(member: zipfile.ZipInfo) -> PurePosixPath:
    return PurePosixPath(member.filename.replace("\\", "/"))


def _by_folder(archive: zipfile.ZipFile) -> dict[str, list[zipfile.ZipInfo]]:
    """Members of each folder that holds a tape, by the folder's own name where that is unique."""
    folders: dict[PurePosixPath, dict[str, zipfile.ZipInfo]] = {}
    for member in archive.infolist():
        path = _path(member)
        if path.name in FILES and not member.is_dir() and "__MACOSX" not in path.parts:
            folders.setdefault(path.parent, {})[path.name] = member
    out: dict[str, list[zipfile.ZipInfo]] = {}
    for folder in sorted(folders, key=str):
        if TAPE in folders[folder]:
            name = folder.name if folder.name not in out else f"{folder.name}-{len(out)}"
            out[name] = list(folders[folder].values())
    return out


def _room(file: Path, members: list[zipfile.ZipInfo], into: Path, most: int) -> int:
    """Bytes that may be unpacked; StudioError where what the zip claims is more."""
    claimed = sum(member.file_size for member in members)
    for member in members:
        largest = _LARGEST.get(_path(member).name, MOST_UNPACKED)
        if member.file_size > min(largest, may_unpack(member.compress_size)):
            raise StudioError(
                f"{file.name}: {member.filename[:80]} unpacks to {member.file_size / 2**20:.0f} MB,"
                " more than such a file holds: it is not what it is called"
            )
    most = min(most, may_unpack(file.stat().st_size))
    free = (shutil.disk_usage(into).free - SPARE) // 2  # unpacked, then copied
    if claimed > min(most, free):
        why = f", {max(0, free) / 2**30:.1f} GB are free for it" if free < most else ""
        raise StudioError(
            f"{file.name} unpacks to {claimed / 2**30:.1f} GB, more than can be taken in{why}:"
            " import fewer takes"
        )
    return min(most, free)


def _copy(
    archive: zipfile.ZipFile, member: zipfile.ZipInfo, target: Path, most: int, begins: bytes = b""
) -> int:
    """Unpack one member; its size. Of one that does not begin with `begins` only the beginning, so
    that whoever reads it sees at once what it is not."""
    size = 0
    with archive.open(member) as source, target.open("wb") as out:
        while block := source.read(_BLOCK):
            if not size and not block.startswith(begins):
                out.write(block[: len(begins)])
                return len(begins)
            size += len(block)
            if size > most:
                raise StudioError(
                    "the zip unpacks to more than can be taken in: import fewer takes"
                )
            out.write(block)
    return size
