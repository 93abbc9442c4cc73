"""Takes to files other programs read; one file per format, listed in FORMATS.

Every export but "takes" covers what the trim leaves, and none changes the take. Formats for
learning (pairs, lerobot, hdf5) and the replay leave cuts out too, and put the person in step with
the robot.
"""

import shutil
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path

from studio.errors import StudioError, unknown_name
from studio.files import whole
from studio.takes.export.as_it_is import write_takes
from studio.takes.export.bvh import write_human_bvh
from studio.takes.export.extent import human_poses, tick_range
from studio.takes.export.hdf5 import write_hdf5
from studio.takes.export.html import write_html
from studio.takes.export.lerobot import write_lerobot
from studio.takes.export.mcap import write_mcap
from studio.takes.export.tables import write_csv, write_frames, write_npz, write_pairs
from studio.takes.take import Take

__all__ = ["FORMATS", "Format", "export", "export_file", "human_poses", "tick_range"]


@dataclass(frozen=True, kw_only=True)
class Format:
    """suffix: of its file or folder. write: takes and a new path. several: more than one take fits.
    folder: it is a folder of files. learning: of episodes, of which a take may hold none. text:
    what it is, with its version, and what it is for."""

    suffix: str
    write: Callable[[Iterable[Take], Path], None]
    text: str
    several: bool = False
    folder: bool = False
    learning: bool = False


def _single(suffix: str, write: Callable[[Take, Path], None], text: str) -> Format:
    def only(takes: Iterable[Take], path: Path) -> None:
        write(next(iter(takes)), path)

    return Format(suffix=suffix, write=only, text=text)


FORMATS: dict[str, Format] = {
    "takes": Format(
        suffix=".takes",
        write=write_takes,
        text="the takes themselves with all their edits, to be imported again",
        several=True,
        folder=True,
    ),
    "mcap": _single(".mcap", write_mcap, "MCAP 0: every stream, figures for viewers"),
    "jsonl": _single(".jsonl", write_frames, "the person, as frames:FILE reads"),
    "npz": _single(".npz", write_npz, "everything, as numpy arrays (NPZ 1.0)"),
    "csv": _single(".csv", write_csv, "the robot, a row a tick (CSV, RFC 4180)"),
    "bvh": _single(".bvh", write_human_bvh, "the person, at 30 Hz (BVH, Y up, cm)"),
    "pairs": _single(".parquet", write_pairs, "training pairs (Parquet 2.6)"),
    "lerobot": Format(
        suffix=".lerobot",
        write=write_lerobot,
        text="LeRobotDataset v3.0, for learning",
        several=True,
        folder=True,
        learning=True,
    ),
    "hdf5": Format(
        suffix=".hdf5",
        write=write_hdf5,
        text="robomimic 0.3's HDF5, for learning",
        several=True,
        learning=True,
    ),
    "html": _single(".html", write_html, "a replay in one file, for any browser"),
}
"""Formats by name."""


def export(take: Take | Sequence[Take], format_name: str, path: Path) -> Path:
    """Write takes in a format of FORMATS; `path` may be a folder to put it in. The file's path.

    Raises StudioError for an unknown format, takes that do not fit it, and a full or read-only
    disk; then nothing is left behind.
    """
    takes = [take] if isinstance(take, Take) else list(take)
    return export_all([take.name for take in takes], takes, format_name, path)


def export_all(
    names: Sequence[str], takes: Iterable[Take], format_name: str, path: Path, name: str = ""
) -> Path:
    """As `export`, of takes that are read one after the other; name: of the file, in a folder.

    Raises StudioError as `export` does, and for several takes where the format holds one.
    """
    if format_name not in FORMATS:
        raise unknown_name("format", format_name, FORMATS)
    chosen = FORMATS[format_name]
    if len(names) != 1 and not chosen.several:
        several = ", ".join(name for name, f in FORMATS.items() if f.several)
        raise StudioError(f"{format_name} holds one take; several fit into {several}")
    name = name or names[0] + (f"-and-{len(names) - 1}-more" if len(names) > 1 else "")
    inside = path.is_dir() and not (chosen.folder and path.suffix == chosen.suffix)
    path = path / f"{name}{chosen.suffix}" if inside else path
    if chosen.folder and path.is_dir() and any(path.iterdir()):
        raise StudioError(f"{path} is there already: choose a new folder")
    try:
        with whole(path, parents=True) as temporary:
            chosen.write(takes, temporary)
    except OSError as error:
        raise StudioError(f"cannot write {path}: {error.strerror or error}") from error
    return path


def export_file(take: Take | Sequence[Take], format_name: str, folder: Path) -> Path:
    """The same as one file, for a download: a format that is a folder is packed into a zip."""
    return packed(export(take, format_name, folder))


def packed(path: Path) -> Path:
    """A folder as a zip beside it; a file as it is. StudioError where it cannot be written."""
    if not path.is_dir():
        return path
    try:
        return Path(shutil.make_archive(str(path), "zip", path.parent, path.name))
    except OSError as error:
        path.with_name(f"{path.name}.zip").unlink(missing_ok=True)
        raise StudioError(f"cannot write {path.name}.zip: {error.strerror or error}") from error
