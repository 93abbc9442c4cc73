"""Many takes to one file: a data set where the format holds several, else a zip of a file each."""

import shutil
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path

from studio.errors import StudioError, unknown_name
from studio.takes.export.archive import SPARE
from studio.takes.export.episodes import episodes
from studio.takes.export.formats import FORMATS, export, export_all, packed
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook
from studio.takes.take import Take


@dataclass(frozen=True, kw_only=True)
class Exported:
    """file: where it lies. takes: how many are in it. left_out: {name: why}."""

    file: Path
    takes: int
    left_out: dict[str, str]


def export_many(
    sessions: Path,
    names: Sequence[str],
    format_name: str,
    folder: Path,
    title: str,
    *,
    rejected: bool = True,
    at: Callable[[int], object] = lambda done: None,
) -> Exported:
    """Write takes into one file in `folder`, which exists, called after `title`.

    Takes that cannot be exported are left out, named with why; rejected: those too that were
    rejected. `at` is told how many have been gone through. Raises StudioError for an unknown
    format, where no take is left, and where the disk is nearly full.
    """
    if format_name not in FORMATS:
        raise unknown_name("format", format_name, FORMATS)
    left_out: dict[str, str] = {}

    def watched(done: int) -> None:
        at(done)
        if shutil.disk_usage(folder).free < SPARE:
            raise StudioError("the disk is nearly full: make room, or export fewer takes")

    library = SessionLibrary(sessions)
    takes = exportable(library, names, format_name, left_out, rejected=rejected, at=watched)
    if FORMATS[format_name].several:
        file = packed(export_all(names, takes, format_name, folder, title))
    else:
        file = folder / f"{title}-{format_name}.zip"
        _zip_of_each(takes, format_name, file, left_out)
    at(len(names))
    if len(left_out) == len(names):
        raise nothing_to_export(left_out)
    return Exported(file=file, takes=len(names) - len(left_out), left_out=left_out)


def _zip_of_each(
    takes: Iterable[Take], format_name: str, file: Path, left_out: dict[str, str]
) -> None:
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        for take in takes:
            try:
                part = export(take, format_name, file.parent)
            except StudioError as error:
                left_out[take.name] = str(error)
                continue
            archive.write(part, part.name)
            part.unlink()


def of_session(library: SessionLibrary, session: str) -> list[str]:
    """The takes of a session that are left; StudioError for none, and an unknown session."""
    known = {info.name for info in library.list()}
    found = [name for name in SessionBook(library.root).read(session).takes if name in known]
    if not found:
        raise StudioError(f"no take of session {session} is left")
    return found


def exportable(
    library: SessionLibrary,
    names: Sequence[str],
    format_name: str,
    left_out: dict[str, str],
    *,
    rejected: bool = False,
    at: Callable[[int], object] = lambda done: None,
) -> Iterator[Take]:
    """The takes, read one after the other, so that memory holds one; of those that cannot be
    exported, and of rejected ones unless they are wanted, `left_out` says why.

    Raises StudioError where there is none.
    """
    for done, name in enumerate(names):
        at(done)
        try:
            take = library.read(name)
            if take.edits.keep is False and not rejected:
                raise StudioError("it was rejected")
            if FORMATS[format_name].learning or not len(take):
                episodes(take)
        except StudioError as error:
            left_out[name] = str(error)
        else:
            yield take
    if len(left_out) == len(names):
        raise nothing_to_export(left_out)


def nothing_to_export(left_out: dict[str, str]) -> StudioError:
    """For where every take was left out."""
    why = "; ".join(f"{name}: {why}" for name, why in list(left_out.items())[:5])
    return StudioError(f"there is nothing to export ({why or 'no take is there'})")
