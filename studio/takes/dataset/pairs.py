"""A take as its edits leave it to training pairs: what the person did, what the robot shows.

A pair is one 30 Hz frame. The person's side goes through the same causal features as live; the
robot's side is the shown motion as `reference.labels` tells it. Trimmed, cut and rejected
frames are left out after the features were computed, so that no filter or difference jumps over a
cut.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.human.calibration import calibrate
from studio.human.features import FEATURE_DIM, clip_features
from studio.human.pose import HumanClip
from studio.reference import labels
from studio.reference.intent import STATES
from studio.robot import a1
from studio.takes.align import synchrony
from studio.takes.columns import Columns, columns
from studio.takes.edit import edited
from studio.takes.edit.edits import Edits, read_edits
from studio.takes.record.meta import MetaLost, read_meta
from studio.takes.session_library import SessionLibrary

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

CERTAIN = 0.5
"""A proposed lag this certain is taken out where nobody accepted or refused one."""
SETTLE = 15
"""Frames at the start of a stretch that are left out: the filters settle."""
LEAST = 30
"""Frames a stretch of one state has to have."""
SHAPES: dict[str, tuple[int, ...]] = {
    **dict.fromkeys(("q", "qd", "qdd"), (FEATURE_DIM,)),
    **{name: (dim,) for name, dim in labels.DIMS.items()},
}


@dataclass(frozen=True, kw_only=True)
class Pairs:
    """N pairs of one take.

    values[name]: (N, …) float32 as in SHAPES: q, qd, qdd of the person (features.FEATURE_NAMES);
    joint_pos rad; base_quat wxyz and the linear rates in the state's frame (walk: the heading;
    stand and sit: the way the feet face), angular rates in the body; base_pos m, world;
    contact in [0, 1]. tick: (N,) which tick of the take. state: (N,) index into STATES.
    lag: s that was taken out, and `aligned` where it came from: "edit", "proposed" (by the take and
    its session) or "none".
    """

    take: str
    label: str
    values: Mapping[str, Array32]
    tick: NDArray[np.int32]
    state: NDArray[np.uint8]
    lag: float
    aligned: str

    def __len__(self) -> int:
        return len(self.tick)


def take_pairs(library: SessionLibrary, name: str, known: tuple[Edits, str] | None = None) -> Pairs:
    """The pairs of a take; none when no person was seen, or it was rejected or cut away.

    known: what `settled` said of it, where it was asked before. Raises StudioError for an unknown
    take or one that cannot be read.
    """
    table, meta = columns(library.folder(name)), _meta(library, name)
    edits, aligned = settled(library, name) if known is None else known
    parts, rows = [], []
    for start, end, state, use in _used(table, edits, meta):
        parts.append(_stretch(table, edits, start, end, state))
        rows.append(use)
    label = edits.label if edits.label is not None else str(meta.get("label", ""))

    def joined(key: str) -> Array32:
        found = [values[key][use] for (_, _, values), use in zip(parts, rows, strict=True)]
        return np.concatenate(found) if found else np.zeros((0, *SHAPES[key]), np.float32)

    tick = [tick[use] for (tick, _, _), use in zip(parts, rows, strict=True)]
    state = [np.full(int(u.sum()), s, np.uint8) for (_, s, _), u in zip(parts, rows, strict=True)]
    return Pairs(
        take=name,
        label=label,
        values={key: joined(key) for key in SHAPES},
        tick=np.concatenate(tick) if tick else np.zeros(0, np.int32),
        state=np.concatenate(state) if state else np.zeros(0, np.uint8),
        lag=edits.lag or 0.0,
        aligned=aligned,
    )


def pair_counts(library: SessionLibrary, name: str) -> dict[str, int]:
    """How many pairs of each state a take has, without making them: `take_pairs`' own, but for what
    a lag that is only proposed takes away at its ends. Raises StudioError as that does."""
    folder = library.folder(name)
    out: dict[str, int] = {**dict.fromkeys(STATES, 0)}
    for _, _, state, use in _used(columns(folder), read_edits(folder).edits, _meta(library, name)):
        out[state] += int(use.sum())
    return out


def why_none(library: SessionLibrary, name: str) -> str:
    """Why there is no pair in a take, in one line."""
    table, edits = columns(library.folder(name)), settled(library, name)[0]
    seen = _seen(table, edited.human_rows(np.arange(len(table)), edits))
    of = states_of(table, _meta(library, name).get("about") or {})
    known = np.isin(of, STATES)
    if not len(table):
        why = "it holds no tick that could be read"
    elif edits.keep is False:
        why = "it was rejected"
    elif not seen.any():
        why = "nobody was seen"
    elif not (known & seen).any():
        why = f"nothing says that it shows one of {', '.join(STATES)}"
    elif not stretches(of, seen):
        why = f"no state was held for {LEAST} ticks ({LEAST / a1.CONTROL_HZ:g} s) in sight"
    else:
        why = f"all is cut but the first {SETTLE} ticks of a state"
    return f"take {name} has no pairs: {why}"


def _meta(library: SessionLibrary, name: str) -> dict[str, Any]:
    try:
        return read_meta(library.folder(name))
    except MetaLost:
        return {}  # a tape whose meta.json was lost still teaches


def settled(library: SessionLibrary, name: str) -> tuple[Edits, str]:
    """A take's edits with a lag: decided, or proposed by it and its session and certain; and which.

    Raises StudioError as `take_pairs`.
    """
    folder = library.folder(name)
    edits = read_edits(folder).edits
    if edits.lag is not None:
        return edits, "edit"
    others = synchrony.session_curves(library, name)
    _, proposed = synchrony.align(columns(folder), edits, others)
    if proposed is None or proposed.certainty < CERTAIN:
        return edits, "none"
    return replace(edits, lag=round(proposed.lag, 4)), "proposed"


def walked_in(library: SessionLibrary, name: str, edits: Edits) -> str | None:
    """The style a take walks in, as it says itself; None where it does not say, or nobody walks in
    what is kept."""
    about = _meta(library, name).get("about") or {}
    style = about.get("style")
    if not style or edits.keep is False:
        return None
    table = columns(library.folder(name))
    walks = (states_of(table, about) == "walk") & edited.kept(len(table), edits)
    return str(style) if walks.any() else None


def states_of(table: Columns, about: Mapping[str, Any]) -> NDArray[np.str_]:
    """(T,) the state of each tick: of what was collected, else of the controller."""
    collected = (about.get("collect") or {}).get("state")
    if collected in STATES:
        return np.full(len(table), collected)
    names = np.array(table.names or ("",))
    return names[np.asarray(table.rows["state"])]


def stretches(state: NDArray[np.str_], usable: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, end) of each run of at least LEAST usable frames (T,) of one known state (T,)."""
    usable = usable & np.isin(state, STATES)
    if not len(state):
        return []
    edge = np.flatnonzero((usable[1:] != usable[:-1]) | (state[1:] != state[:-1])) + 1
    bounds = [0, *edge.tolist(), len(state)]
    return [(a, b) for a, b in pairwise(bounds) if b - a >= LEAST and usable[a]]


def _used(
    table: Columns, edits: Edits, meta: Mapping[str, Any]
) -> list[tuple[int, int, str, NDArray[np.bool_]]]:
    """(start, end, state, which ticks from start + SETTLE on are pairs) of each stretch."""
    at = edited.human_rows(np.arange(len(table)), edits)
    keep = edited.kept(len(table), edits) & (edits.keep is not False)
    keep &= (at >= 0.0) & (at <= len(table) - 1)  # beyond the tape nobody is there to learn from
    of = states_of(table, meta.get("about") or {})
    found = stretches(of, _seen(table, at))
    return [(a, b, str(of[a]), keep[a + SETTLE : b]) for a, b in found]


def _seen(table: Columns, at: Array) -> NDArray[np.bool_]:
    there = np.isfinite(table.rows["human_t"])
    low = np.clip(np.floor(at), 0, len(table) - 1).astype(int)
    return there[low] & there[np.minimum(low + 1, len(table) - 1)]


def _stretch(
    table: Columns, edits: Edits, start: int, end: int, state: Any
) -> tuple[NDArray[np.int32], int, dict[str, Array32]]:
    """Ticks, state and values of the frames of one stretch, but for the first SETTLE."""
    ticks = np.arange(start, end)
    joints, confidence = edited.human_at(table, edited.human_rows(ticks, edits))
    clip = HumanClip(
        name="take",
        t=np.float64(a1.CONTROL_DT) * (ticks - start),
        joint_pos_w=joints,
        confidence=confidence,
    )
    known = calibrate([clip[i] for i in range(0, len(clip), 10)])
    q, qd, qdd = clip_features(clip, known)
    pos, quat, joint_pos = (
        np.asarray(table.rows[f"reference_{key}"][start:end], dtype=np.float64)
        for key in ("base_pos", "base_quat", "joint_pos")
    )
    robot = labels.label_motion(state, pos, quat, joint_pos, a1.CONTROL_DT)
    values = {"q": q, "qd": qd, "qdd": qdd} | robot
    late = slice(SETTLE, None)
    return (
        ticks[late].astype(np.int32),
        STATES.index(state),
        {key: value[late].astype(np.float32) for key, value in values.items()},
    )
