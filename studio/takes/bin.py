"""Takes thrown away, `.bin` in the sessions folder: nothing is lost until somebody empties it."""

import os
import shutil
from datetime import datetime
from pathlib import Path

from studio.errors import StudioError
from studio.takes.names import take_folder

BIN = ".bin"


def _place(root: Path, folder: Path) -> Path:
    return root / BIN / f"{folder.name}.{datetime.now():%Y%m%d-%H%M%S-%f}"


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


def names(root: Path) -> list[str]:
    """Names of the takes in the bin, the last one deleted last."""
    found = sorted(
        (stamp, name)
        for path in (root / BIN).glob("*")
        for name, _, stamp in [path.name.partition(".")]
        if stamp and path.is_dir()
    )
    return list(dict.fromkeys(name for _, name in found))


def bring_back(root: Path, name: str) -> None:
    """Bring the take of this name that was deleted last back from the bin.

    Raises StudioError if the bin has none, or another take has the name by now.
    """
    target = take_folder(root, name)
    found = sorted((root / BIN).glob(f"{name}.*"))
    if not found:
        known = ", ".join(names(root)[-8:]) or "nothing"
        raise StudioError(f"no take {name!r} in the bin; it holds: {known}")
    if target.exists():
        raise StudioError(f"a take named {name} exists: delete that one first")
    try:
        found[-1].rename(target)
        os.utime(target)
    except OSError as error:
        raise StudioError(f"take {name} was not restored: {error.strerror}") from error
