"""A take as its edits leave it to training pairs: what the person did, what the robot shows.

A pair is one 30 Hz frame. The person's side goes through the same causal features as live; the
robot's side is the shown motion in its state's frame, with derivatives by backward differences
over 0.1 s and contact labels by `reference.contact`. Trimmed, cut and rejected frames are left
out after the features were computed, so that no filter or difference jumps over a cut.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.calibration import calibrate
from studio.human.features import DELTA_FRAMES, FEATURE_DIM, clip_features
from studio.human.pose import HumanClip
from studio.reference.contact import contact_labels
from studio.reference.intent import STATES, StateName
from studio.reference.stances import NEUTRAL
from studio.robot import a1, kinematics
from studio.takes.align import synchrony
from studio.takes.columns import Columns, columns
from studio.takes.edit import edited
from studio.takes.edit.edits import Edits, read_edits
from studio.takes.library import SessionLibrary
from studio.takes.take import MetaLost, read_meta

Array = NDArray[np.float64]
Array32 = NDArray[np.float32]

CERTAIN = 0.5
"""A proposed lag this certain is taken out where nobody accepted or refused one."""
SETTLE = 15
"""Frames at the start of a stretch that are left out: the filters settle."""
LEAST = 30
"""Frames a stretch of one state has to have."""
SHAPES: dict[str, tuple[int, ...]] = {
    "q": (FEATURE_DIM,), "qd": (FEATURE_DIM,), "qdd": (FEATURE_DIM,),
    "joint_pos": (12,), "base_quat": (4,), "base_pos": (3,), "contact": (4,),
    "joint_vel": (12,), "joint_acc": (12,), "base_lin_vel": (3,), "base_lin_acc": (3,),
    "base_ang_vel": (3,), "base_ang_acc": (3,),
}  # fmt: skip


@dataclass(frozen=True, kw_only=True)
class Pairs:
    """N pairs of one take.

    values[name]: (N, …) float32 as in SHAPES: q, qd, qdd of the person (features.FEATURE_NAMES);
    joint_pos rad; base_quat wxyz and the linear rates in the state's frame (walk: the heading;
    stand and sit: the way the robot faced at rest), angular rates in the body; base_pos m, world;
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
    keep = edited.kept(len(table), edits) & (edits.keep is not False)
    at = edited.human_rows(np.arange(len(table)), edits)
    keep &= (at >= 0.0) & (at <= len(table) - 1)  # beyond the tape nobody is there to learn from
    of = states_of(table, meta.get("about") or {})
    parts = [_stretch(table, edits, a, b, of[a]) for a, b in stretches(of, _seen(table, at))]
    rows = [keep[tick] for tick, _, _ in parts]
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
    """(start, end) of each run of at least LEAST usable frames of one known state."""
    usable = usable & np.isin(state, STATES)
    if not len(state):
        return []
    edge = np.flatnonzero((usable[1:] != usable[:-1]) | (state[1:] != state[:-1])) + 1
    bounds = [0, *edge.tolist(), len(state)]
    return [(a, b) for a, b in pairwise(bounds) if b - a >= LEAST and usable[a]]


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
    values = {"q": q, "qd": qd, "qdd": qdd} | robot_values(state, pos, quat, joint_pos)
    late = slice(SETTLE, None)
    return (
        ticks[late].astype(np.int32),
        STATES.index(state),
        {key: value[late].astype(np.float32) for key, value in values.items()},
    )


def facing(state: StateName, base_quat: Array) -> float:
    """Heading (rad) of the feet in a stretch whose first frame is at or near the neutral pose."""
    turn = geometry.quat_mul(base_quat[0], geometry.quat_conj(NEUTRAL[state].base_quat))
    return float(2.0 * np.arctan2(turn[3], turn[0]))


def robot_values(
    state: StateName, base_pos: Array, base_quat: Array, joint_pos: Array
) -> dict[str, Array]:
    """The robot's side of SHAPES, of a motion (T, 3), (T, 4), (T, 12) at 30 Hz."""
    n, dt = len(joint_pos), a1.CONTROL_DT
    walks = state == "walk"
    yaw = geometry.heading(base_quat) if walks else np.full(n, facing(state, base_quat))
    frame = np.zeros((n, 4))
    frame[:, 0], frame[:, 3] = np.cos(0.5 * yaw), np.sin(0.5 * yaw)
    back = np.maximum(np.arange(n) - DELTA_FRAMES, 0)

    def rate(x: Array) -> Array:
        return (x - x[back]) / (DELTA_FRAMES * dt)

    turn = geometry.quat_mul(geometry.quat_conj(base_quat[back]), base_quat)
    ang_vel = geometry.quat_to_rotvec(turn) / (DELTA_FRAMES * dt)
    lin_vel = rate(base_pos)
    foot = kinematics.foot_pos_w(base_pos, base_quat, joint_pos)
    quat = geometry.quat_mul(geometry.quat_conj(frame), base_quat)
    return {
        "joint_pos": joint_pos,
        "base_quat": np.where(quat[:, :1] < 0.0, -quat, quat),
        "base_pos": base_pos,
        "contact": contact_labels(foot, dt),
        "joint_vel": rate(joint_pos),
        "joint_acc": rate(rate(joint_pos)),
        "base_lin_vel": geometry.quat_rotate_inverse(frame, lin_vel),
        "base_lin_acc": geometry.quat_rotate_inverse(frame, rate(lin_vel)),
        "base_ang_vel": ang_vel,
        "base_ang_acc": rate(ang_vel),
    }
