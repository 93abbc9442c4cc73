"""A take's folder from elsewhere into the sessions folder, whole or not at all."""

import os
import shutil
from pathlib import Path

from studio.errors import StudioError
from studio.recording.edits import EDITS
from studio.recording.names import take_folder
from studio.recording.recorder import META, TAPE
from studio.recording.take import survey_take


def add_take(root: Path, folder: Path, name: str | None = None, *, link: bool = False) -> str:
    """Copy a take's folder from elsewhere into the folder `root`; its name here.

    link: share the tape with the original, which is never written to again.
    """
    source = Path(folder)
    if not link:
        survey_take(source)  # refuses what is no take, or of another version
    name = name or source.name
    target = take_folder(root, name)
    if target.exists():
        raise StudioError(f"a take named {name} exists: give another name")
    files = [source / f for f in (META, TAPE, EDITS) if (source / f).is_file()]
    temporary = root / f".import-{os.getpid()}-{name}"
    try:
        temporary.mkdir(parents=True)
        for file in files:
            if link and file.name == TAPE:
                _share(file, temporary / file.name)
            else:
                shutil.copyfile(file, temporary / file.name)
        temporary.rename(target)
    except OSError as error:
        shutil.rmtree(temporary, ignore_errors=True)
        raise StudioError(f"{source.name} was not imported: {error.strerror}") from error
    return name


def _share(file: Path, target: Path) -> None:
    try:
        target.hardlink_to(file)
    except OSError:  # a file system without links
        shutil.copyfile(file, target)
