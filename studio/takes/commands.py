"""`a1-studio takes …`: one function per command, sessions folder in, plain values out."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.reference.intent import STATES
from studio.takes.align import synchrony
from studio.takes.dataset import datasets
from studio.takes.edit import edited, review
from studio.takes.export.adding import add_all
from studio.takes.export.formats import export, export_all
from studio.takes.export.lerobot_read import import_lerobot, is_lerobot
from studio.takes.export.many import exportable, of_session
from studio.takes.record.meta import TAPE
from studio.takes.record.repair import repair
from studio.takes.session_library import SessionLibrary


def list_takes(sessions: Path) -> dict[str, Any]:
    """{"takes": [TakeInfo …]}."""
    return {"takes": [info.as_dict() for info in SessionLibrary(sessions).list()]}


def show_take(sessions: Path, name: str) -> dict[str, Any]:
    """One take's line with what the tape itself says: streams' counts, states, meta.json."""
    library = SessionLibrary(sessions)
    take = library.read(name)
    states: dict[str, int] = {}
    for tick in take.ticks:
        states[tick.state] = states.get(tick.state, 0) + 1
    return library.info(name).as_dict() | {
        "seconds": round(take.seconds, 6),
        "ticks": len(take),
        "problems": list(take.problems),
        "human_frames": 0 if take.human is None else len(take.human),
        "state_seconds": {
            k: round(v * take.seconds / max(1, len(take)), 6) for k, v in states.items()
        },
        "meta": take.meta,
    }


def trim_take(
    sessions: Path, name: str, start: float | None = None, end: float | None = None
) -> dict[str, Any]:
    """Keep only [start, end] s; a missing bound is the take's own, both missing clears the trim."""
    library = SessionLibrary(sessions)
    if start is None and end is None:
        return library.edit(name, trim=None).as_dict()
    last = library.info(name).seconds
    return library.edit(name, trim=(start or 0.0, last if end is None else end)).as_dict()


def label_take(sessions: Path, name: str, label: str) -> dict[str, Any]:
    """Give a take another label."""
    return SessionLibrary(sessions).edit(name, label=label).as_dict()


def undo_take(sessions: Path, name: str) -> dict[str, Any]:
    """Take the last edit back."""
    return SessionLibrary(sessions).undo(name).as_dict()


def redo_take(sessions: Path, name: str) -> dict[str, Any]:
    """Do the last edit taken back again."""
    return SessionLibrary(sessions).redo(name).as_dict()


def review_take(sessions: Path, name: str) -> dict[str, Any]:
    """What was found in a take: suggestions, alignment before and proposed, score and why."""
    return review.review(SessionLibrary(sessions), name).as_dict()


def align_take(
    sessions: Path,
    name: str,
    warp: bool = False,
    refuse: bool = False,
    show: bool = False,
    alone: bool = False,
) -> dict[str, Any]:
    """Find how late the person was and take it out: {"before", "after", "lag", "warp"}.

    warp: bend time too, where the tempo wandered; null in the answer where both agree no better
    with it. refuse: leave the take as it was acted, on purpose. show: only say what would be done.
    alone: by this take only, not by the others of its session. `takes undo` takes it back.
    """
    library = SessionLibrary(sessions)
    if show:
        table, edits = edited.open_table(sessions, name)
        others = [] if alone else synchrony.session_curves(library, name)
        before, found = synchrony.align(table, edits, others)
    elif refuse:
        synchrony.refuse_alignment(library, name)
        table, edits = edited.open_table(sessions, name)
        before = found = synchrony.align(table, edits)[0]
    else:
        before, found = synchrony.accept_alignment(library, name, warp=warp, alone=alone)
        review.review(library, name)
        table, edits = edited.open_table(sessions, name)
    return {
        "name": name,
        "before": None if before is None else asdict(before),
        "after": None if found is None else asdict(found),
        "lag": edits.lag,
        "warp": None if edits.warp is None else len(edits.warp),
        "certain": found is not None and found.certainty >= 0.5,
    }


def clean_take(sessions: Path, name: str) -> dict[str, Any]:
    """Cut out everything a review would leave out."""
    library = SessionLibrary(sessions)
    edits = review.accept_suggestions(library, name)
    return {"name": name, "cuts": edits.cuts, "score": review.review(library, name).score}


def split_take(sessions: Path, name: str, at: float) -> dict[str, Any]:
    """Cut a take in two at a time (s): {"takes": [the first half, the second]}."""
    return {"takes": [half.as_dict() for half in SessionLibrary(sessions).split(name, at)]}


def restore_take(sessions: Path, name: str) -> dict[str, Any]:
    """Bring the take of this name that was deleted last back from the bin."""
    return SessionLibrary(sessions).restore(name).as_dict()


def verify_takes(sessions: Path, name: str | None = None) -> dict[str, Any]:
    """{"takes": […]}; a take with "readable" false is what exit status 1 is for."""
    return {"takes": SessionLibrary(sessions).verify(name)}


def repair_take(sessions: Path, name: str) -> dict[str, Any]:
    """Make a take whole whose recording was killed or whose files are damaged, for any reader.

    The take as it was goes to the bin; one that is whole is left alone.
    """
    library = SessionLibrary(sessions)
    return repair(library.root, library.folder(name))


def delete_take(sessions: Path, name: str) -> dict[str, Any]:
    """Move a take to the bin."""
    return {"name": name, "bin": str(SessionLibrary(sessions).delete(name))}


def export_take(
    sessions: Path,
    name: str | None = None,
    format: str = "npz",
    out: Path | None = None,
    more: tuple[str, ...] = (),
    session: str | None = None,
    all: bool = False,
) -> dict[str, Any]:
    """Write a take as npz, csv, jsonl, bvh, mcap, pairs, lerobot, hdf5, html, or takes (as it is).

    `export NAME --format F`, or of many takes `--session NAME` or `--all` in NAME's place.
    Into the working folder by default. Into the same file (lerobot, hdf5) go: more: further takes;
    session: every take of a session; all: every take there is. Of a session and of all, takes that
    were rejected or hold nothing to export are left out, and named with why. Raises StudioError
    unless one of the three is given, and as `export` does.
    """
    library = SessionLibrary(sessions)
    if sum((name is not None, session is not None, all)) != 1:
        raise StudioError("say what to export: a take's name, --session NAME, or --all")
    path = Path.cwd() if out is None else out
    if name is not None:
        takes = [library.read(n) for n in (name, *more)]
        return {"name": name, "format": format, "file": str(export(takes, format, path))}
    title = session or Path(sessions).resolve().name
    found = of_session(library, session) if session else [t.name for t in library.list()]
    left_out: dict[str, str] = {}
    takes = exportable(library, found, format, left_out)
    file = export_all(found, takes, format, path, title)
    return {"name": title, "format": format, "file": str(file), "left_out": left_out}


def import_take(sessions: Path, folder: Path, name: str | None = None) -> dict[str, Any]:
    """Copy takes from elsewhere: one take's folder, a folder of takes, or a LeRobotDataset of ours.

    From the last two they get names that are free, and those refused are named with why.
    """
    lerobot = is_lerobot(folder)
    inside = sorted(p.parent for p in folder.glob(f"*/{TAPE}"))
    if not lerobot and ((folder / TAPE).exists() or not inside):
        return {"takes": [SessionLibrary(sessions).add(folder, name)]}
    if name is not None:
        raise StudioError("the takes in a folder have names of their own: leave the name out")
    if lerobot:
        return import_lerobot(Path(sessions), folder)
    taken, refused = add_all(sessions, inside)
    return {"takes": taken, "refused": refused}


def dataset_takes(
    sessions: Path,
    names: tuple[str, ...] = (),
    states: tuple[str, ...] = STATES,
    style: str = "march",
) -> dict[str, Any]:
    """Make a data set version of these takes (all that were kept without names); its manifest."""
    library = SessionLibrary(sessions)
    return datasets.build(library, names or None, states=states, style=style).manifest
