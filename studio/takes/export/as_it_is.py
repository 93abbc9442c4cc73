"""Takes to a folder of takes as they lie in the library: nothing is left out, edits included."""

import shutil
from collections.abc import Iterable
from pathlib import Path

from studio.errors import StudioError
from studio.takes.edit.edits import EDITS
from studio.takes.export.episodes import nothing_left
from studio.takes.record.meta import META, TAPE
from studio.takes.take import Take


def write_takes(takes: Iterable[Take], path: Path) -> None:
    """Tape, what is known about it, and every edit: what `takes import` takes in again.

    Raises StudioError for a take without a tick, which would be refused there.
    """
    path.mkdir()
    for take in takes:
        if not len(take):
            raise StudioError(nothing_left(take))
        (path / take.name).mkdir()
        for name in (TAPE, META, EDITS):
            if (take.path / name).is_file():
                shutil.copyfile(take.path / name, path / take.name / name)
