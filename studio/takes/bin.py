"""Takes thrown away, `.bin` in the sessions folder: nothing is lost until somebody empties it.

A take lies there as NAME.STAMP, its place: what was deleted twice under a name lies there twice.
"""

import os
import re
import shutil
from contextlib import suppress
from dataclasses import dataclass
from datetime import datetime
from pathlib import Path

from studio.errors import StudioError
from studio.takes.listing import TakeInfo, examine
from studio.takes.names import take_folder

BIN = ".bin"
_STAMP = "%Y%m%d-%H%M%S-%f"
_PLACE = re.compile(r"([A-Za-z0-9_-]{1,120})\.(\d{8}-\d{6}-\d{6})\Z")


@dataclass(frozen=True, kw_only=True)
class Binned:
    """A take in the bin. place: where in it. deleted: when, ISO 8601. bytes: what deleting it for
    good frees. take: its line, as it was in the list."""

    place: str
    deleted: str
    bytes: int
    take: TakeInfo


def _place(root: Path, folder: Path) -> Path:
    return root / BIN / f"{folder.name}.{datetime.now():{_STAMP}}"


def keep_copy(root: Path, folder: Path) -> Path:
    """A copy of a take in the bin, before it is changed; where it lies.

    Raises StudioError if it cannot be written; then nothing is left of it.
    """
    target = _place(root, folder)
    try:
        return Path(shutil.copytree(folder, target, ignore=shutil.ignore_patterns("*.tmp")))
    except (OSError, shutil.Error) as error:
        shutil.rmtree(target, ignore_errors=True)
        raise StudioError(f"take {folder.name} could not be copied first: {error}") from error


def throw(root: Path, folder: Path) -> Path:
    """Move a take's folder into the bin; where it lies now. StudioError if it cannot be moved."""
    target = _place(root, folder)
    try:
        target.parent.mkdir(exist_ok=True)
        folder.rename(target)
    except OSError as error:
        raise StudioError(f"take {folder.name} was not deleted: {error.strerror}") from error
    return target


def contents(root: Path) -> list[Binned]:
    """Everything in the bin, the last one deleted last. Never raises."""
    return [
        Binned(
            place=folder.name,
            deleted=when.astimezone().isoformat(timespec="seconds"),
            bytes=_bytes(folder),
            take=examine(folder, name),
        )
        for when, name, folder in _all(root)
    ]


def names(root: Path) -> list[str]:
    """Names of the takes in the bin, the last one deleted last."""
    return list(dict.fromkeys(name for _, name, _ in _all(root)))


def is_place(name: str) -> bool:
    """Whether that is a place of the bin: no take is called so."""
    return _PLACE.match(name) is not None


def folder_at(root: Path, place: str) -> Path:
    """The folder of the take at a place of the bin. StudioError if there is none."""
    return _known(root, place)[0]


def bring_back(root: Path, name: str) -> None:
    """Bring the take of this name that was deleted last back from the bin.

    Raises StudioError if the bin has none, or another take has the name by now.
    """
    take_folder(root, name)
    found = [folder for _, known, folder in _all(root) if known == name]
    if not found:
        known = ", ".join(names(root)[-8:]) or "nothing"
        raise StudioError(f"no take {name!r} in the bin; it holds: {known}")
    bring_back_from(root, found[-1].name)


def bring_back_from(root: Path, place: str) -> str:
    """Bring back the take at this place of the bin; its name. Errors as `bring_back`."""
    folder, name = _known(root, place)
    target = take_folder(root, name)
    if target.exists():
        raise StudioError(f"a take named {name} exists: delete that one first")
    try:
        folder.rename(target)
        os.utime(target)
    except OSError as error:
        raise StudioError(f"take {name} was not restored: {error.strerror}") from error
    return name


def delete_for_good(root: Path, place: str) -> None:
    """Delete the take at this place of the bin. StudioError if it is not there, or will not go."""
    folder, name = _known(root, place)
    try:
        shutil.rmtree(folder)
    except OSError as error:
        raise StudioError(f"take {name} was not deleted for good: {error.strerror}") from error


def _known(root: Path, place: str) -> tuple[Path, str]:
    """The folder at a place, and the take's name. No place leads out of the bin."""
    fits = _PLACE.match(place)
    folder = root / BIN / place
    if fits is None or folder.is_symlink() or not folder.is_dir():
        raise StudioError(f"nothing lies at {place[:160]!r} in the bin")
    return folder, fits[1]


def _all(root: Path) -> list[tuple[datetime, str, Path]]:
    """(when deleted, name, folder), sorted."""
    found = []
    for path in (root / BIN).glob("*"):
        fits = _PLACE.match(path.name)
        if fits and path.is_dir() and not path.is_symlink():
            with suppress(ValueError):  # no time, though it looks like one
                found.append((datetime.strptime(fits[2], _STAMP), fits[1], path))
    return sorted(found)


def _bytes(folder: Path) -> int:
    """Of the files that nobody else holds: halves of a take share its tape."""
    about = [path.lstat() for path in folder.glob("*")]
    return sum(file.st_size for file in about if file.st_nlink == 1)
