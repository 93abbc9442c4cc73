"""A data set version, made from takes as their edits leave them, to what a mapper learns from.

And what is held out of it, to tell what the mapper is worth.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from studio.errors import StudioError
from studio.reference.intent import STATES
from studio.takes.dataset import datasets
from studio.takes.dataset.datasets import DataSet
from studio.takes.session_library import SessionLibrary
from studio.training.enough import Counts, held_takes, learnt_of
from studio.training.operator_pairs import PairSet


@dataclass(frozen=True, kw_only=True)
class TakePairs:
    """parts[state][take]: pairs. version: of the data set they are. takes: all names."""

    parts: Mapping[str, Mapping[str, PairSet]]
    takes: tuple[str, ...]
    version: str

    def by_take(self, state: str) -> Mapping[str, PairSet]:
        """A state's pairs per take."""
        return self.parts.get(state, {})

    @property
    def counts(self) -> Counts:
        """How many pairs, by state and take."""
        return {s: {t: len(pairs) for t, pairs in of.items()} for s, of in self.parts.items()}

    def count(self, state: str) -> int:
        """How many pairs a state has."""
        return sum(len(pairs) for pairs in self.by_take(state).values())


def read_pairs(
    sessions: Path,
    takes: Sequence[str],
    dataset: str | None = None,
    style: str = "march",
    *,
    walk: bool = True,
) -> TakePairs:
    """The pairs of takes, or of a data set version.

    Takes become a version first, so that what a mapper was trained on can be had again. style:
    which human motion means walking; walk: whether walking is learnt at all. StudioError where
    there is nothing to learn, or walking in another style.
    """
    if dataset is not None:
        data = datasets.load(Path(sessions), dataset)
        of = data.manifest["style"]
        if walk and of != style and len(data.of("walk")["tick"]):
            raise StudioError(
                f"walking is in style {of}, not {style}, in data set {dataset}: train with"
                f" --style {of}, or choose another data set"
            )
        return of_data_set(data)
    if not takes:
        raise StudioError("choose at least one take to train on (--takes NAME …)")
    states = [s for s in STATES if walk or s != "walk"]
    library = SessionLibrary(sessions)
    return of_data_set(datasets.build(library, list(takes), states=states, style=style))


def of_data_set(data: DataSet) -> TakePairs:
    """A version's rows by state and take."""
    names = [str(row["name"]) for row in data.manifest["takes"]]
    parts: dict[str, dict[str, PairSet]] = {}
    for k, state in enumerate(STATES):
        for i, name in enumerate(names):
            rows = np.flatnonzero((data.arrays["state"] == k) & (data.arrays["take"] == i))
            if len(rows):
                parts.setdefault(state, {})[name] = _pair_set(data, rows)
    return TakePairs(parts=parts, takes=tuple(names), version=data.version)


def _pair_set(data: DataSet, rows: np.ndarray) -> PairSet:
    values = {name: value[rows] for name, value in data.arrays.items()}
    triplet = np.concatenate([values["q"], values["qd"], values["qdd"]], axis=1)
    return PairSet.of(triplet, values, values["take"])


@dataclass(frozen=True, kw_only=True)
class Split:
    """A state's pairs: learnt from, and held out. how: in words, for the sidecar."""

    known: PairSet
    held: PairSet
    how: str
    takes: tuple[str, ...] = field(default=())


def split_pairs(parts: Mapping[str, PairSet]) -> Split:
    """Hold out a fifth: whole takes where there are at least five, else the end of each.

    Whole takes are the harder test: another motion, not the rest of one that was learnt.
    """
    names = sorted(parts)
    if last := held_takes(len(names)):
        known, held = names[:-last], names[-last:]
        return Split(
            known=PairSet.join([parts[n] for n in known]),
            held=PairSet.join([parts[n] for n in held]),
            how=f"{last} whole take{'s' if last > 1 else ''} of {len(names)}",
            takes=tuple(names),
        )
    first, second = [], []
    for name in names:
        cut = learnt_of(len(parts[name]))
        rows = np.arange(len(parts[name]))
        first.append(parts[name].take(rows[:cut]))
        second.append(parts[name].take(rows[cut:]))
    return Split(
        known=PairSet.join(first),
        held=PairSet.join(second),
        how="the last fifth of each take",
        takes=tuple(names),
    )
