"""Takes as their edits leave them to the pairs a mapper learns from: a PairSet a state and take.

The person goes through the same causal features as live; the robot is what was shown. Which state
a frame belongs to is what was collected, or, in a free recording, what the controller did.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.human.features import clip_features
from studio.human.pose import HumanClip
from studio.recording import review
from studio.recording.columns import Columns, columns
from studio.recording.edits import Edits, read_edits
from studio.recording.library import SessionLibrary
from studio.recording.take import read_meta
from studio.reference.intent import STATES, StateName
from studio.robot.a1 import CONTROL_DT
from studio.training.operator_pairs import PairSet, label_motion

SETTLE = 15
"""Frames at the start of a stretch that are left out: the filters settle."""
LEAST = 30
"""Frames a stretch must have to be used."""


@dataclass(frozen=True, kw_only=True)
class TakePairs:
    """parts[state][take]: pairs. version: of the data set they are, or None. takes: all names."""

    parts: Mapping[str, Mapping[str, PairSet]]
    takes: tuple[str, ...]
    version: str | None = None

    def by_take(self, state: str) -> Mapping[str, PairSet]:
        """A state's pairs per take."""
        return self.parts.get(state, {})

    def count(self, state: str) -> int:
        """How many pairs a state has."""
        return sum(len(pairs) for pairs in self.by_take(state).values())


def read_pairs(sessions: Path, takes: Sequence[str]) -> TakePairs:
    """The pairs of takes. StudioError for an unknown take, or where there is nothing to learn."""
    if not takes:
        raise StudioError("choose at least one take to train on (--takes NAME …)")
    library = SessionLibrary(sessions)
    parts: dict[str, dict[str, PairSet]] = {state: {} for state in STATES}
    for name in dict.fromkeys(takes):
        folder = library.folder(name)
        for state, pairs in pairs_of(folder).items():
            parts[state][name] = pairs
    return TakePairs(parts=parts, takes=tuple(dict.fromkeys(takes)))


def pairs_of(folder: Path) -> dict[StateName, PairSet]:
    """One take's pairs by state; {} when no person was seen or everything is cut."""
    table, edits = columns(folder), read_edits(folder).edits
    edits = with_lag(table, edits)
    keep = review.kept(len(table), edits)
    at = review.human_rows(np.arange(len(table)), edits)
    # Beyond the tape's ends there is nobody to learn from.
    keep &= (at >= 0.0) & (at <= len(table) - 1)
    joints, confidence = review.human_at(table, at)
    keep &= np.isfinite(joints).all(axis=(1, 2))
    of = states_of(table, read_meta(folder).get("about") or {})
    found: dict[StateName, list[PairSet]] = {}
    for start, end in stretches(of, keep):
        pairs = _stretch(table, joints, confidence, start, end, str(of[start]))
        found.setdefault(of[start], []).append(pairs)
    return {state: PairSet.join(parts) for state, parts in found.items()}


def with_lag(table: Columns, edits: Edits) -> Edits:
    """The edits, with the lag that is proposed where nobody accepted or refused one."""
    if edits.lag is not None:
        return edits
    _, proposed = review.align(table, edits)
    if proposed is None or proposed.certainty <= 0.0:
        return edits
    values = {name: getattr(edits, name) for name in Edits.__dataclass_fields__}
    return Edits(**values | {"lag": proposed.lag})


def states_of(table: Columns, about: Mapping[str, Any]) -> NDArray[np.str_]:
    """(T,) the state of each tick: of what was collected, else of the controller."""
    collected = (about.get("collect") or {}).get("state")
    if collected in STATES:
        return np.full(len(table), collected)
    return np.array(table.names)[np.asarray(table.rows["state"])]


def stretches(state: NDArray[np.str_], keep: NDArray[np.bool_]) -> list[tuple[int, int]]:
    """(start, end) of each run of at least LEAST kept frames of one known state."""
    usable = keep & np.isin(state, STATES)
    edge = np.flatnonzero((usable[1:] != usable[:-1]) | (state[1:] != state[:-1])) + 1
    bounds = [0, *edge.tolist(), len(state)]
    return [(a, b) for a, b in pairwise(bounds) if b - a >= LEAST and usable[a]]


def _stretch(
    table: Columns, joints: NDArray, confidence: NDArray, start: int, end: int, state: Any
) -> PairSet:
    clip = HumanClip(
        name="take",
        t=np.arange(end - start) * CONTROL_DT,
        joint_pos_w=np.asarray(joints[start:end], dtype=np.float64),
        confidence=np.asarray(confidence[start:end], dtype=np.float64),
    )
    known = calibrate([clip[i] for i in range(0, len(clip), 10)])
    triplet = np.concatenate(clip_features(clip, known), axis=-1)
    rows = table.rows[start:end]
    pos, quat, joint_pos, contact = (
        np.asarray(rows[f"reference_{key}"], dtype=np.float64)
        for key in ("base_pos", "base_quat", "joint_pos", "foot_contact")
    )
    robot = label_motion(state, pos, quat, joint_pos, CONTROL_DT)
    kept = slice(SETTLE, None)
    return PairSet(
        triplet=triplet[kept].astype(np.float32),
        contact=contact[kept].astype(np.float32),
        clip=np.zeros(end - start - SETTLE, dtype=np.int64),
        **{name: x[kept].astype(np.float32) for name, x in robot.items()},
    )
