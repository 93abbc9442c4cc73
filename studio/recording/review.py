"""A take and its edits to what an operator judges it by: suggestions, alignment, score, curves.

Everything is worked out in blocks or windows of the take's table (`columns`), so that an hour
costs no more memory than a minute. The tape is never changed; what is accepted becomes an edit.
"""

import contextlib
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.recording import alignment, cleaning, lag
from studio.recording import edits as edit_log
from studio.recording.alignment import Alignment
from studio.recording.cleaning import Suggestion
from studio.recording.columns import CACHE, Columns, columns
from studio.recording.edits import Edits
from studio.recording.library import SessionLibrary
from studio.recording.quality import Quality, median_jerk, quality
from studio.recording.recorder import TAPE
from studio.recording.sessions import SessionBook
from studio.recording.take import read_meta
from studio.robot import a1

Array = NDArray[np.float64]

BLOCK_S, OVERLAP_S = 60.0, 1.0
"""s of a block in which suggestions are looked for, and how far blocks overlap."""
ALIGN_S = 120.0
"""s, the liveliest stretch of a long take that the lag is found on."""
SESSION_TAKES = 12
"""Other takes of a session that help to find a take's lag."""
WARP_KNOT_S = 0.5
MOST_FRAMES = 1800
"""Frames a window holds at most; longer windows are thinned."""


@dataclass(frozen=True, kw_only=True)
class Review:
    """What was found in a take as its edits leave it.

    kept_seconds: within the trim and outside the cuts. suggestions: of what is kept, s into the
    take. before: the alignment as it is (lag of the edits, its correlation); found: the one
    proposed, None when nothing moves or no person was seen. score: [0, 1], also written to the
    take; quality: why. problems: of the tape.
    """

    name: str
    seconds: float
    kept_seconds: float
    ticks: int
    edits: Edits
    suggestions: tuple[Suggestion, ...]
    before: Alignment | None
    found: Alignment | None
    quality: Quality
    score: float
    problems: tuple[str, ...] = ()

    def as_dict(self) -> dict[str, Any]:
        """Plain values for JSON."""
        return asdict(self)


def review(library: SessionLibrary, name: str) -> Review:
    """Look a take over, and write its score into the list unless somebody gave it one.

    Raises StudioError for an unknown take or one that cannot be read.
    """
    folder = library.folder(name)
    table, edits = columns(folder), edit_log.read_edits(folder).edits
    if not len(table):
        raise StudioError(f"take {name} holds no tick that could be reviewed: delete it")
    keep = kept(len(table), edits)
    seconds = float(keep.sum()) / a1.CONTROL_HZ
    found = [s for s in suggestions(table) if _touches(s, keep)]
    before, proposed = align(table, edits, session_curves(library, name))
    left = None
    if before is not None and proposed is not None:
        # What is still out of step, and how well the two agree once that is put right.
        left = Alignment(
            lag=proposed.lag - before.lag if proposed.certainty > 0.0 else 0.0,
            correlation=proposed.correlation,
            certainty=proposed.certainty,
        )
    start, end = _liveliest(table, keep)
    wrists = np.asarray(table.rows["human"][start:end, [7, 10]], dtype=np.float64)
    verdict = quality(
        seconds=seconds,
        found=found,
        alignment=left,
        jerk_m_s3=median_jerk(wrists, a1.CONTROL_DT) if np.isfinite(wrists).all() else 0.0,
        fallen_share=float(np.mean(table.rows["fallen"][keep])) if seconds else 0.0,
    )
    score = round(verdict.score / 100.0, 4)
    if edits.score is None or abs(edits.score - score) > 5e-5:
        # A score somebody gave stays: `found` rows never stand over a decision.
        edit_log.record(folder, score=score)
    return Review(
        name=name,
        seconds=table.seconds,
        kept_seconds=seconds,
        ticks=len(table),
        edits=edits,
        suggestions=tuple(found),
        before=before,
        found=proposed,
        quality=verdict,
        score=score,
        problems=(table.problem,) if table.problem else (),
    )


def kept(ticks: int, edits: Edits) -> NDArray[np.bool_]:
    """(T,) which ticks the trim and the cuts leave."""
    t = np.arange(ticks) / a1.CONTROL_HZ
    start, end = edits.trim or (0.0, np.inf)
    out = (t >= start - 1e-9) & (t < end - 1e-9)
    for start, end in edits.cuts or ():
        out &= (t < start - 1e-9) | (t > end + 1e-9)
    return out


def suggestions(table: Columns) -> list[Suggestion]:
    """Everything `cleaning` finds in the human stream, at times of the take; block by block."""
    size, more = round(BLOCK_S * a1.CONTROL_HZ), round(OVERLAP_S * a1.CONTROL_HZ)
    out: list[Suggestion] = []
    for first, rows in table.blocks(size, more):
        at = np.flatnonzero(rows["fresh"])
        if len(at) < 3:
            continue
        t, used = np.asarray(rows["human_t"][at]), (first + at) / a1.CONTROL_HZ
        if not np.all(np.diff(t) > 0.0):
            t = used  # a source that looped: the time of use stands in
        pos = np.asarray(rows["human"][at], dtype=np.float64)
        confidence = np.asarray(rows["confidence"][at], dtype=np.float64)
        for s in cleaning.suggestions(t, pos, confidence):
            start, end = np.interp([s.start, s.end], t, used)
            out.append(
                Suggestion(kind=s.kind, start=start, end=end, share=s.share, message=s.message)
            )
    return _merged(out)


def _merged(found: list[Suggestion]) -> list[Suggestion]:
    """Those of a kind that overlap (blocks do) as one, in order of time."""
    out: list[Suggestion] = []
    last: dict[str, int] = {}
    for s in sorted(found, key=lambda s: (s.start, s.end)):
        i = last.get(s.kind)
        if i is not None and s.start < out[i].end - 1e-9:
            a = out[i]
            out[i] = Suggestion(
                kind=s.kind,
                start=a.start,
                end=max(a.end, s.end),
                share=max(a.share, s.share),
                message=a.message,
            )
        else:
            last[s.kind] = len(out)
            out.append(s)
    return out


def _touches(s: Suggestion, keep: NDArray[np.bool_]) -> bool:
    a, b = int(s.start * a1.CONTROL_HZ), int(np.ceil(s.end * a1.CONTROL_HZ)) + 1
    return bool(keep[a:b].any())


def _liveliest(table: Columns, keep: NDArray[np.bool_]) -> tuple[int, int]:
    """First row and one past the last of at most ALIGN_S within what is kept, where most moves."""
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


def align(
    table: Columns, edits: Edits, others: Sequence[lag.Curve] = ()
) -> tuple[Alignment | None, Alignment | None]:
    """The alignment as the edits have it, and the one proposed; None where there is no telling.

    others: curves of the session's other takes, see `session_curves`.
    """
    human, robot = _sides(table, *_liveliest(table, kept(len(table), edits)))
    if human is None or robot is None:
        return None, None
    proposed = lag.align(human, robot, a1.CONTROL_DT, others)
    if proposed.correlation == 0.0 and proposed.certainty == 0.0:
        return None, None
    return lag.agreement(human, robot, a1.CONTROL_DT, edits.lag or 0.0), proposed


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
    key = [lag.SAMPLES_HZ, len(table), (folder / TAPE).stat().st_mtime_ns, edits.trim, edits.cuts]
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
    human, robot = _sides(table, *_liveliest(table, kept(len(table), edits)))
    own = None if human is None or robot is None else lag.curve(human, robot, a1.CONTROL_DT)
    values = (
        None
        if own is None
        else {k: getattr(own, k).tolist() for k in ("lags", "level", "explained")}
    )
    with contextlib.suppress(OSError):
        cache.write_bytes(msgspec.json.encode({"key": key, "curve": values}))
    return own


def propose_warp(table: Columns, edits: Edits, late: float) -> tuple[tuple[float, float], ...]:
    """Knots ((t, shift), …) s of a time warp on top of a lag, WARP_KNOT_S apart, over the trim."""
    start, end = _ends(table, edits)
    human, robot = _sides(table, start, end)
    if human is None or robot is None:
        return ()
    last = len(human.channels) - 1
    at = np.clip(np.arange(last + 1) + round(late / a1.CONTROL_DT), 0, last)
    shift = alignment.time_warp(human.channels[at], robot.channels, a1.CONTROL_DT)
    step = max(1, round(WARP_KNOT_S / a1.CONTROL_DT))
    knots = list(range(0, len(shift), step))
    return tuple((round((start + i) * a1.CONTROL_DT, 6), round(float(shift[i]), 4)) for i in knots)


def _ends(table: Columns, edits: Edits) -> tuple[int, int]:
    rows = np.flatnonzero(kept(len(table), edits))
    return (int(rows[0]), int(rows[-1]) + 1) if len(rows) else (0, 0)


def _sides(
    table: Columns, start: int, end: int
) -> tuple[lag.HumanSide | None, lag.RobotSide | None]:
    rows = table.rows[start:end]
    seen = np.flatnonzero(np.isfinite(rows["human_t"]))
    if len(seen) < 2:
        return None, None
    human = np.asarray(rows["human"], dtype=np.float64)
    human[: seen[0]] = human[seen[0]]  # before the first pose: as it then was
    if not np.isfinite(human).all():  # gone for a while: as last seen
        last = np.where(np.isfinite(rows["human_t"]), np.arange(len(rows)), seen[0])
        human = human[np.maximum.accumulate(last)]
    return lag.human_side(human), lag.robot_side(
        *(
            np.asarray(rows[f"reference_{key}"], dtype=np.float64)
            for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
        )
    )


def accept_alignment(
    library: SessionLibrary, name: str, *, warp: bool = False, alone: bool = False
) -> tuple[Alignment | None, Alignment | None]:
    """Make the proposed lag (and a time warp on top) an edit; before and after.

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
    changes: dict[str, Any] = {"lag": late, "warp": None}
    if warp:
        changes["warp"] = propose_warp(table, edits, late) or None
    library.edit(name, **changes)
    return before, proposed


def refuse_alignment(library: SessionLibrary, name: str) -> None:
    """Leave the take as it was acted, on purpose: lag 0, no warp."""
    library.edit(name, lag=0.0, warp=None)


def accept_suggestions(library: SessionLibrary, name: str, which: list[int] | None = None) -> Edits:
    """Cut out suggestions of the present review, by index (all of them without)."""
    found = review(library, name)
    chosen = found.suggestions if which is None else []
    for i in which or ():
        if not 0 <= i < len(found.suggestions):
            raise StudioError(
                f"there is no suggestion {i}: take {name} has {len(found.suggestions)}"
            )
        chosen = [*chosen, found.suggestions[i]]
    if not chosen:
        raise StudioError(f"there is nothing to cut out of take {name}")
    cuts = [*(found.edits.cuts or ()), *((s.start, max(s.end, s.start + 1e-3)) for s in chosen)]
    library.edit(name, cuts=tuple(cuts))
    return edit_log.read_edits(library.folder(name)).edits


def human_rows(ticks: NDArray[np.int64], edits: Edits) -> Array:
    """Fractional row (…,) of the human that belongs to the robot at these ticks."""
    shift = np.full(len(ticks), edits.lag or 0.0)
    if edits.warp:
        t, more = np.array(edits.warp).T
        shift = shift + np.interp(ticks / a1.CONTROL_HZ, t, more)
    return ticks + shift * a1.CONTROL_HZ


def human_at(table: Columns, at: Array) -> tuple[Array, Array]:
    """Joints (N, 19, 3) m and confidence (N, 19) at fractional rows (N,), linear between rows.

    Beyond the take's ends its first and last pose stand; without a person NaN and 0.
    """
    at = np.clip(at, 0, len(table) - 1)
    low = np.floor(at).astype(int)
    high = np.minimum(low + 1, len(table) - 1)
    first = int(low.min(initial=0))
    rows = table.rows[first : int(high.max(initial=0)) + 1]
    w = (at - low)[:, None, None]
    pos, confidence = rows["human"], rows["confidence"]
    return (
        (1.0 - w) * pos[low - first] + np.where(w > 0.0, w * pos[high - first], 0.0),
        np.minimum(confidence[low - first], confidence[high - first]).astype(np.float64),
    )


def window(
    table: Columns,
    edits: Edits,
    start: float,
    end: float,
    *,
    aligned: bool = True,
    most: int = MOST_FRAMES,
) -> dict[str, Any]:
    """Both sides between two times (s), for a player: arrays of at most `most` frames.

    t (N,) s; human (N, 19, 3) m and confidence; reference_* and robot_* poses; state (N,) names;
    kept (N,). aligned: the human as lag and warp put it; else as it was recorded.
    """  # fmt: skip
    a = int(np.clip(start * a1.CONTROL_HZ, 0, len(table)))
    b = int(np.clip(np.ceil(end * a1.CONTROL_HZ), a, len(table)))
    step = max(1, -(-(b - a) // most))
    ticks = np.arange(a, b, step)
    rows = table.rows[a:b:step]
    human, confidence = human_at(
        table, human_rows(ticks, edits) if aligned else ticks.astype(np.float64)
    )
    out: dict[str, Any] = {
        "t": ticks / a1.CONTROL_HZ,
        "human": human,
        "confidence": confidence,
        "state": [table.names[i] for i in rows["state"]],
        "kept": kept(len(table), edits)[a:b:step],
    }
    for who in ("reference", "robot"):
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact"):
            out[f"{who}_{key}"] = np.asarray(rows[f"{who}_{key}"], dtype=np.float64)
    return out


def overview(table: Columns, edits: Edits, points: int = 600) -> dict[str, Any]:
    """The whole take at `points` instants, for a timeline: t (N,) s, human and robot (N, 7) in
    units of `alignment.CHANNELS`, aligned as the edits have it, state (N,) names."""
    count = min(max(2, points), len(table))
    ticks = np.unique(np.linspace(0, len(table) - 1, count).astype(int))
    rows = table.rows[ticks]
    # Row by row where the human is sought: fancy indexing reads only these pages.
    at = np.clip(np.rint(human_rows(ticks, edits)).astype(int), 0, len(table) - 1)
    human = np.asarray(table.rows["human"][at], dtype=np.float64)
    robot = [
        np.asarray(rows[f"reference_{key}"], dtype=np.float64)
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    ]
    return {
        "t": ticks / a1.CONTROL_HZ,
        "channels": list(alignment.CHANNELS),
        "human": alignment.scaled_human(alignment.human_channels(human)),
        "robot": alignment.scaled_robot(alignment.robot_channels(*robot)),
        "state": [table.names[i] for i in rows["state"]],
    }


def open_table(sessions: Path, name: str) -> tuple[Columns, Edits]:
    """A take's table and edits, by name."""
    folder = SessionLibrary(sessions).folder(name)
    return columns(folder), edit_log.read_edits(folder).edits
