"""The synthetic operator beside real people: 5th to 95th percentiles of q, q̇, q̈, as a figure.

`a1-studio evaluate operator_statistics --clips DIR --figure models/operator_statistics.png`

Two shares, since either alone misleads. *Coverage*: of each feature's real range, what lies inside
the operator's. It counts how often, not only how far: who bends as deep as anybody, but seldom,
covers little; and a hip's range of a few millimetres weighs as much as a hand's of a metre. *Near*:
of the real frames, those beside which some frame of the operator's is, all joints at once.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.evaluation.clips import read_labels
from studio.evaluation.operator_plot import plot
from studio.evaluation.operator_ranges import Ranges
from studio.evaluation.options import TableOptions
from studio.human.calibration import calibrate
from studio.human.features import clip_features
from studio.human.pose import HumanClip
from studio.mocap.clip_source import ClipSource
from studio.reference.intent import STATES
from studio.reference.library import TASKS
from studio.retarget.selector import NAMES
from studio.sources import open_source, spec_of
from studio.synthetic import Person, exercise, play, squats
from studio.synthetic.exercises import windmill_arms
from studio.synthetic.signals import of_track
from studio.synthetic.wide import DRILL, SQUAT_HOLD_S
from studio.timing import CONTROL_HZ
from studio.training.machine import commit
from studio.training.operator_pairs import BOTH_SHARE, both_arms
from studio.training.selector_data import UNLABELLED, labels

Array = NDArray[np.float64]

COVERED = ("position_coverage", "velocity_coverage", "acceleration_coverage")
SIMILAR = ("position_near", "velocity_near", "acceleration_near")


def real_features(folder: Path) -> dict[str, Array]:
    """Per state (3, N, F) features of the labelled frames of the clips in `folder`.

    `labels.json` there tells, per file, which stretches are stand, walk or sit. Raises
    StudioError where there is none, or nothing is labelled.
    """
    found: dict[str, list[Array]] = {state: [] for state in STATES}
    for name, spans in read_labels(folder).items():
        if not spans:
            continue
        clip = _load(folder / name).at_rate(CONTROL_HZ)
        triplet = _features(clip)
        for span in spans:
            inside = (clip.t >= span["from"]) & (clip.t <= span["to"])
            found[span["expert"]].append(triplet[:, inside])
    if not any(found.values()):
        raise StudioError(f"the labels in {folder} are of nothing: files need spans with an expert")
    return {state: np.concatenate(parts, axis=1) for state, parts in found.items() if parts}


def operator_features(
    people: int, rng: np.random.Generator, family: str = "default"
) -> dict[str, Array]:
    """Per state (3, N, F) features of people doing every task, exercises and squats, 12 s each;
    what a frame is, as in the selector's own data (`selector_data.labels`)."""
    found: dict[str, list[Array]] = {state: [] for state in STATES}
    for _ in range(people):
        person = Person.sample(rng, family, sensor="mocap")
        for signal in _signals(family, rng):
            performance = play(signal, person, rng, "operator")
            state = labels(performance.true_pos_w)
            triplet = _features(performance.clip)
            state[:30] = UNLABELLED  # the filters settle
            for k, name in enumerate(NAMES):
                found[name].append(triplet[:, state == k])
    return {state: np.concatenate(parts, axis=1) for state, parts in found.items()}


def _signals(family: str, rng: np.random.Generator) -> list[Array]:
    """What one person does, (T, NUM) each."""
    signals = [of_track(task.sample(rng, 12.0)) for task in TASKS.values()]
    if family != "wide":
        signals += [of_track(exercise(rng, 12.0)) for _ in range(6)]
        return signals + [squats(rng, 12.0) for _ in range(3)]
    signals = [of_track(t.sample(rng, 12.0)) for t in TASKS.values() if t.state != "stand"]
    for _ in range(12):
        track = windmill_arms(exercise(rng, 12.0, DRILL), twists=rng.random() < 0.5)
        signals.append(of_track(both_arms(track, rng)[0] if rng.random() < BOTH_SHARE else track))
    return signals + [squats(rng, 12.0, SQUAT_HOLD_S) for _ in range(6)]


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate operator_statistics`."""

    clips: Path
    """Folder of labelled real motion clips."""
    episodes: int = 24
    """Synthetic people, of each family."""
    family: str | None = None
    """Of the synthetic people: default, held_out or wide (default: the first and the last)."""
    figure: Path | None = None
    """Also draw the ranges into this file (.png)."""


def run_operator_statistics(options: Options) -> dict[str, Any]:
    """`{"rows": [...]}` per family and state: the share of the real ranges that is covered, and of
    the real frames that are near one of the operator's."""
    families = ("default", "wide") if options.family is None else (options.family,)
    real = real_features(options.clips)
    found = {
        family: operator_statistics(real, options.episodes, options.seed, family)
        for family in families
    }
    if options.figure is not None:
        plot(found, options.figure)
    made_by = commit()
    return {
        "rows": [
            {
                "state": state,
                "controller": "synthetic operator",
                "family": family,
                "seed": options.seed,
                "episodes": options.episodes,
                "commit": made_by,
                "frames": ranges.frames,
                **dict(zip(COVERED, map(float, ranges.coverage.mean(axis=1)), strict=True)),
                **dict(zip(SIMILAR, map(float, ranges.near), strict=True)),
            }
            for family, ranges_of in found.items()
            for state, ranges in ranges_of.items()
        ]
    }


def operator_statistics(
    real: dict[str, Array], people: int = 24, seed: int = 0, family: str = "default"
) -> dict[str, Ranges]:
    """Ranges per state of real features (3, N, F) and of as many sampled people."""
    acted = operator_features(people, np.random.default_rng(seed), family)
    return {state: Ranges.of(x, acted[state]) for state, x in real.items()}


def _features(clip: HumanClip) -> Array:
    known = calibrate([clip[i] for i in range(0, len(clip), 3)])
    return np.stack(clip_features(clip, known))


def _load(path: Path) -> HumanClip:
    source = open_source(spec_of(path))
    assert isinstance(source, ClipSource)
    return source.clip
