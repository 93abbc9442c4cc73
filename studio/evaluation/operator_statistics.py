"""The synthetic operator beside real people: 5th to 95th percentiles of q, q̇, q̈, as a figure.

`a1-studio evaluate operator_statistics --clips DIR --figure models/operator_statistics.png`
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.evaluation.clips import read_labels
from studio.evaluation.options import TableOptions
from studio.human.calibration import calibrate
from studio.human.features import FEATURE_NAMES, clip_features
from studio.human.pose import HumanClip
from studio.mocap.clip_source import ClipSource
from studio.reference.intent import STATES
from studio.reference.library import TASKS
from studio.retarget.selector import NAMES
from studio.sources import open_source, spec_of
from studio.synthetic import Person, exercise, play, squats
from studio.synthetic.signals import of_track
from studio.timing import CONTROL_HZ
from studio.training.machine import commit
from studio.training.selector_data import UNLABELLED, labels

Array = NDArray[np.float64]

ORDERS = ("q", "q̇", "q̈")
COVERED = ("position_coverage", "velocity_coverage", "acceleration_coverage")
LOW, HIGH = 5.0, 95.0


@dataclass(frozen=True, kw_only=True)
class Ranges:
    """Percentiles of one state's features.

    real, operator: (3, 2, F) orders q, q̇, q̈ × (5th, 95th) × features. frames: real ones.
    """

    real: Array
    operator: Array
    frames: int

    @property
    def coverage(self) -> Array:
        """(3, F) share of the real range that lies inside the operator's."""
        low = np.maximum(self.real[:, 0], self.operator[:, 0])
        high = np.minimum(self.real[:, 1], self.operator[:, 1])
        width = np.maximum(self.real[:, 1] - self.real[:, 0], 1e-6)
        return np.clip((high - low) / width, 0.0, 1.0)


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
        signals = [of_track(task.sample(rng, 12.0)) for task in TASKS.values()]
        signals += [of_track(exercise(rng, 12.0)) for _ in range(6)]
        signals += [squats(rng, 12.0) for _ in range(3)]
        for signal in signals:
            performance = play(signal, person, rng, "operator")
            state = labels(performance.true_pos_w)
            triplet = _features(performance.clip)
            state[:30] = UNLABELLED  # the filters settle
            for k, name in enumerate(NAMES):
                found[name].append(triplet[:, state == k])
    return {state: np.concatenate(parts, axis=1) for state, parts in found.items()}


@dataclass(frozen=True, kw_only=True)
class Options(TableOptions):
    """Of `evaluate operator_statistics`."""

    clips: Path
    """Folder of labelled real motion clips."""
    episodes: int = 12
    """Synthetic people."""
    family: str = "default"
    """Of the synthetic people: default or held_out."""
    figure: Path | None = None
    """Also draw the ranges into this file (.png)."""


def run_operator_statistics(options: Options) -> dict[str, Any]:
    """`{"rows": [...]}` per state: the share of the real ranges that the operator covers."""
    found = operator_statistics(options.clips, options.episodes, options.seed, options.family)
    if options.figure is not None:
        plot(found, options.figure)
    made_by = commit()
    return {
        "rows": [
            {
                "state": state,
                "controller": "synthetic operator",
                "seed": options.seed,
                "episodes": options.episodes,
                "commit": made_by,
                "frames": ranges.frames,
                **dict(zip(COVERED, map(float, ranges.coverage.mean(axis=1)), strict=True)),
            }
            for state, ranges in found.items()
        ]
    }


def operator_statistics(
    clips: Path, people: int = 12, seed: int = 0, family: str = "default"
) -> dict[str, Ranges]:
    """Ranges per state of the labelled clips of a folder and of as many sampled people."""
    real = real_features(clips)
    acted = operator_features(people, np.random.default_rng(seed), family)
    return {
        state: Ranges(real=_percentiles(x), operator=_percentiles(acted[state]), frames=x.shape[1])
        for state, x in real.items()
    }


def _percentiles(x: Array) -> Array:
    return np.moveaxis(np.percentile(x, [LOW, HIGH], axis=1), 0, 1)


def _features(clip: HumanClip) -> Array:
    known = calibrate([clip[i] for i in range(0, len(clip), 3)])
    return np.stack(clip_features(clip, known))


def _load(path: Path) -> HumanClip:
    source = open_source(spec_of(path))
    assert isinstance(source, ClipSource)
    return source.clip


def plot(statistics: dict[str, Ranges], path: Path) -> None:
    """Draw the ranges: a row per state, a column per order, a pair of bars per feature."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    order = _drawing_order()
    x = np.arange(len(order))
    units = ("m", "m/s", "m/s²")
    figure, axes = plt.subplots(
        len(statistics), 3, figsize=(17, 2.9 * len(statistics) + 1.5), sharex=True, squeeze=False
    )
    for row, (state, ranges) in zip(axes, statistics.items()):
        for k, axis in enumerate(row):
            acted, real = ranges.operator[k][:, order], ranges.real[k][:, order]
            axis.bar(x, acted[1] - acted[0], 0.9, acted[0], color="#a9c7e8", label="operator")
            axis.bar(x, real[1] - real[0], 0.36, real[0], color="#c8553d", label="real people")
            axis.set_title(
                f"{state}  {ORDERS[k]} [{units[k]}]   {100 * ranges.coverage[k].mean():.0f} % "
                "of the real range covered",
                fontsize=9,
                loc="left",
            )
            axis.grid(axis="y", alpha=0.3)
            axis.spines[["top", "right"]].set_visible(False)
            axis.tick_params(labelsize=7)
            axis.margins(x=0.01)
            for edge in _part_edges(order):
                axis.axvline(edge - 0.5, color="k", lw=0.4, alpha=0.4)
    for axis in axes[-1]:
        axis.set_xticks(x, [FEATURE_NAMES[i] for i in order], rotation=90, fontsize=5)
    axes[0, 0].legend(fontsize=8, loc="upper left", frameon=False, ncols=2)
    frames = ", ".join(f"{r.frames} {s}" for s, r in statistics.items())
    figure.suptitle(
        "The synthetic operator beside real people: 5th to 95th percentile of every feature\n"
        f"joints relative to the pelvis on the template's body (height in leg lengths); real: "
        f"labelled frames of the CMU and Kinect clips ({frames})",
        fontsize=11,
    )
    figure.tight_layout()
    path.parent.mkdir(parents=True, exist_ok=True)
    figure.savefig(path, dpi=100)
    plt.close(figure)


_PARTS = ("spine", "chest", "neck", "head", "_shoulder", "_elbow", "_wrist", "_hip", "_knee",
          "_ankle", "_toe", "height")  # fmt: skip


def _part(name: str) -> int:
    return next(i for i, part in enumerate(_PARTS) if name.split(".")[0].endswith(part))


def _drawing_order() -> list[int]:
    """Features by body part, then axis, then side."""
    return sorted(
        range(len(FEATURE_NAMES)),
        key=lambda i: (_part(FEATURE_NAMES[i]), FEATURE_NAMES[i][-1], FEATURE_NAMES[i]),
    )


def _part_edges(order: list[int]) -> list[int]:
    parts = [_part(FEATURE_NAMES[i]) for i in order]
    return [i for i in range(1, len(parts)) if parts[i] != parts[i - 1]]
