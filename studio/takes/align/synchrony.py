"""How late the person of a take was, by it and by its session, and what is done about it.

A lag and a warp that are accepted become edits; a take's own curve is kept beside its table.
"""

import contextlib
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.files import write_whole
from studio.robot import a1
from studio.takes.align import alignment, lag, likelihood
from studio.takes.align.alignment import Alignment
from studio.takes.columns import CACHE, Columns, columns
from studio.takes.edit import edits as edit_log
from studio.takes.edit.edited import ends, human_rows, kept
from studio.takes.edit.edits import Edits
from studio.takes.record.meta import TAPE, read_meta
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook

ALIGN_S = 120.0
"""s, the liveliest stretch of a long take that the lag is found on."""
SESSION_TAKES = 12
"""Other takes of a session that help to find a take's lag."""
WARP_KNOT_S = 0.5


def align(
    table: Columns, edits: Edits, others: Sequence[lag.Curve] = ()
) -> tuple[Alignment | None, Alignment | None]:
    """The alignment as the edits have it, and the one proposed; None where there is no telling.

    others: curves of the session's other takes, see `session_curves`.
    """
    acted = _both(table, edits)
    if acted is None:
        return None, None
    proposed = lag.align(*acted, a1.CONTROL_DT, others)
    if proposed.correlation == 0.0 and proposed.certainty == 0.0:
        return None, None
    if edits.warp:
        return _warped_agreement(table, edits), proposed
    return lag.agreement(*acted, a1.CONTROL_DT, edits.lag or 0.0), proposed


def _warped_agreement(table: Columns, edits: Edits) -> Alignment | None:
    both = _both(table, edits, edits)
    if both is None:
        return None
    # A warp is drawn on top of the lag: what is read through it is in time already.
    return replace(lag.agreement(*both, a1.CONTROL_DT, 0.0), lag=edits.lag or 0.0)


def _both(
    table: Columns, edits: Edits, aligned: Edits | None = None
) -> tuple[lag.HumanSide, lag.RobotSide] | None:
    """`_sides` over the liveliest stretch of what the edits keep, None where one is missing."""
    start, end = liveliest(table, kept(len(table), edits))
    human, robot = _sides(table, start, end, aligned)
    return None if human is None or robot is None else (human, robot)


def session_curves(library: SessionLibrary, name: str) -> list[lag.Curve]:
    """How likely each lag is by the newest other takes of a take's session that were not rejected;
    empty for a take that belongs to none."""
    try:
        collected = (read_meta(library.folder(name)).get("about") or {}).get("collect") or {}
        names = SessionBook(library.root).read(str(collected.get("session"))).takes
    except StudioError:
        return []
    found: list[lag.Curve] = []
    for other in reversed(names):
        if other == name or len(found) == SESSION_TAKES:
            continue
        try:
            own = _curve(library.folder(other))
        except StudioError:
            continue  # deleted meanwhile, or damaged
        if own is not None:
            found.append(own)
    return found


def _curve(folder: Path) -> lag.Curve | None:
    """A take's own curve, kept beside its table: asked for again with each of its session."""
    edits = edit_log.read_edits(folder).edits
    if edits.keep is False:
        return None
    table = columns(folder)
    key = [
        likelihood.VERSION,
        len(table),
        (folder / TAPE).stat().st_mtime_ns,
        edits.trim,
        edits.cuts,
    ]
    cache = folder.parent / CACHE / f"{folder.name}.lag.json"
    try:
        known = msgspec.json.decode(cache.read_bytes())
        if known["key"] == msgspec.to_builtins(key):
            values = known["curve"]
            return (
                None if values is None else lag.Curve(**{k: np.array(v) for k, v in values.items()})
            )
    except (OSError, KeyError, TypeError, msgspec.MsgspecError):
        pass
    human, robot = _sides(table, *liveliest(table, kept(len(table), edits)))
    own = None if human is None or robot is None else lag.curve(human, robot, a1.CONTROL_DT)
    values = (
        None
        if own is None
        else {k: getattr(own, k).tolist() for k in ("lags", "level", "place", "explained")}
    )
    with contextlib.suppress(OSError):
        write_whole(cache, msgspec.json.encode({"key": key, "curve": values}))
    return own


def liveliest(table: Columns, keep: NDArray[np.bool_]) -> tuple[int, int]:
    """First row and one past the last of at most ALIGN_S s within `keep` (T,), where most moves."""
    rows = np.flatnonzero(keep)
    if not len(rows):
        return 0, 0
    first, last, size = int(rows[0]), int(rows[-1]) + 1, round(ALIGN_S * a1.CONTROL_HZ)
    if last - first <= size:
        return first, last
    step = round(a1.CONTROL_HZ)  # one joint pose a second tells where the robot moves
    joints = np.asarray(table.rows["reference_joint_pos"][first:last:step], dtype=np.float64)
    moved = np.concatenate([[0.0], np.abs(np.diff(joints, axis=0)).sum(axis=1)])
    total = np.cumsum(moved)
    width = size // step
    start = first + step * int(np.argmax(total[width:] - total[:-width]))
    return start, start + size


def _sides(
    table: Columns, start: int, end: int, edits: Edits | None = None
) -> tuple[lag.HumanSide | None, lag.RobotSide | None]:
    """Both over these rows; the human as the lag and warp of `edits` put it."""
    rows = table.rows[start:end]
    seen = np.flatnonzero(np.isfinite(rows["human_t"]))
    if len(seen) < 2:
        return None, None
    human = np.asarray(rows["human"], dtype=np.float64)
    human[: seen[0]] = human[seen[0]]  # before the first pose: as it then was
    if not np.isfinite(human).all():  # gone for a while: as last seen
        last = np.where(np.isfinite(rows["human_t"]), np.arange(len(rows)), seen[0])
        human = human[np.maximum.accumulate(last)]
    if edits is not None:
        at = np.clip(human_rows(np.arange(start, end), edits) - start, 0, len(human) - 1)
        low = np.floor(at).astype(int)
        part = (at - low)[:, None, None]
        human = (1.0 - part) * human[low] + part * human[np.minimum(low + 1, len(human) - 1)]
    return lag.human_side(human), lag.robot_side(
        *(
            np.asarray(rows[f"reference_{key}"], dtype=np.float64)
            for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
        )
    )


def propose_warp(table: Columns, edits: Edits, late: float) -> tuple[tuple[float, float], ...]:
    """Knots ((t, shift), …) s of a time warp on top of a lag, WARP_KNOT_S apart, over the trim."""
    start, end = ends(table, edits)
    human, robot = _sides(table, start, end)
    if human is None or robot is None:
        return ()
    last = len(human.channels) - 1
    at = np.clip(np.arange(last + 1) + round(late / a1.CONTROL_DT), 0, last)
    shift = alignment.time_warp(human.channels[at], robot.channels, a1.CONTROL_DT)
    step = max(1, round(WARP_KNOT_S / a1.CONTROL_DT))
    knots = list(range(0, len(shift), step))
    return tuple((round((start + i) * a1.CONTROL_DT, 6), round(float(shift[i]), 4)) for i in knots)


def accept_alignment(
    library: SessionLibrary, name: str, *, warp: bool = False, alone: bool = False
) -> tuple[Alignment | None, Alignment | None]:
    """Make the proposed lag (and a time warp on top) an edit; before and after.

    A warp with which both agree no better than without is left out: nothing wandered, or too much.
    alone: by this take only, though others of its session tell how late the person is.
    Raises StudioError when there is nothing to go by.
    """
    folder = library.folder(name)
    table, edits = columns(folder), edit_log.read_edits(folder).edits
    others = [] if alone else session_curves(library, name)
    before, proposed = align(table, edits, others)
    if before is None or proposed is None:
        raise StudioError(f"take {name} cannot be aligned: nothing moves, or no person was seen")
    late = round(proposed.lag, 4)
    knots = propose_warp(table, edits, late) if warp else ()
    if knots and (acted := _both(table, edits)):
        without = lag.agreement(*acted, a1.CONTROL_DT, late)
        with_it = _warped_agreement(table, replace(edits, lag=late, warp=knots))
        if with_it is None or with_it.correlation <= without.correlation:
            knots = ()
        else:
            proposed = replace(proposed, correlation=with_it.correlation)
    library.edit(name, lag=late, warp=knots or None)
    return before, proposed


def refuse_alignment(library: SessionLibrary, name: str) -> None:
    """Leave the take as it was acted, on purpose: lag 0, no warp."""
    library.edit(name, lag=0.0, warp=None)
