"""A take's folder from elsewhere into the sessions folder, whole or not at all."""

import contextlib
import os
import shutil
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.files import scratch_folder
from studio.takes.edit.edits import EDITS
from studio.takes.names import check_take, fit_name, slug, take_folder
from studio.takes.record.meta import META, TAPE, MetaLost, read_meta
from studio.takes.record.recorder import Recorder
from studio.takes.sessions import SessionBook
from studio.takes.take import iter_tape, survey_take
from studio.takes.tick import Tick

SCRATCH = ".import-"
"""Beginning of folders in which takes are made ready; no name of a take begins with a dot."""


def add_take(root: Path, folder: Path, name: str | None = None, *, link: bool = False) -> str:
    """Copy a take's folder from elsewhere into the folder `root`; its name here.

    link: share the tape with the original, which is never written to again. Raises StudioError
    for what is no take, for a name that is taken, and if it cannot be written.
    """
    source = Path(folder)
    # The survey refuses what is no take, or of another version.
    if not link and not survey_take(source).ticks:
        raise StudioError(f"{source.name} holds no tick: nothing was recorded, or all is damaged")
    name = source.name if name is None else name
    target = take_folder(root, check_take(name))
    if target.exists():
        raise StudioError(f"a take named {name} exists: give another name")
    files = [source / f for f in (META, TAPE, EDITS) if (source / f).is_file()]
    try:
        root.mkdir(parents=True, exist_ok=True)
        with scratch_folder(SCRATCH, root) as scratch:
            ready = scratch / name
            ready.mkdir()
            for file in files:
                if link and file.name == TAPE:
                    _share(file, ready / file.name)
                else:
                    shutil.copyfile(file, ready / file.name)
            ready.rename(target)
        with contextlib.suppress(MetaLost):
            meta = read_meta(target)
            about = meta.get("about")
            if isinstance(about, dict):
                SessionBook(root).rejoin(name, about, str(meta.get("started", ""))[:10])
    except OSError as error:
        raise StudioError(f"{source.name} was not imported: {error.strerror}") from error
    return name


def record_take(
    root: Path, ticks: Iterable[Tick], *, label: str, about: dict[str, Any], name: str
) -> str:
    """Ticks that were made elsewhere as a take of the library, whole or not at all; its name."""
    check_take(name)
    root.mkdir(parents=True, exist_ok=True)
    # Beside the library, not in it: a studio may be recording there.
    with scratch_folder(SCRATCH, root) as scratch:
        recorder = Recorder(scratch)
        try:
            recorder.start(label, name=name, about=about)
            for tick in ticks:
                recorder.append(tick)
        finally:
            recorder.close()
        return add_take(root, scratch / name, name)


def add_mcap(root: Path, file: Path, name: str | None = None) -> str:
    """The take in an MCAP file that we exported, or in a tape of another name; its name here.

    Its label is the file's name: the rest of what a take knows about itself lies beside its tape.
    """
    if not sum(1 for _ in iter_tape(file)):
        raise StudioError(f"{file.name} holds no tick of a take")
    about, label = {"source": f"import:{file.name}"}, slug(file.stem)
    return record_take(
        root,
        iter_tape(file),
        label=label,
        about=about,
        name=free_name(root, file.stem) if name is None else name,
    )


def free_name(root: Path, wanted: str) -> str:
    """`wanted`, made fit to be a take's name, with a number after it where it is taken."""
    name = fit_name(wanted)
    tried, number = name, 2
    while os.path.lexists(root / tried):
        tried, number = f"{name}-{number}", number + 1
    return tried


def add_all(root: Path, folders: Iterable[Path]) -> tuple[list[str], dict[str, str]]:
    """Copy takes in under names that are free: (names here, {folder's name: why refused})."""
    taken: list[str] = []
    refused: dict[str, str] = {}
    for folder in folders:
        try:
            taken.append(add_take(root, folder, free_name(root, folder.name)))
        except StudioError as error:
            refused[folder.name] = str(error)
    return taken, refused


def _share(file: Path, target: Path) -> None:
    try:
        target.hardlink_to(file)
    except OSError:  # a file system without links
        shutil.copyfile(file, target)
