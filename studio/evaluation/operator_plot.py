"""Real people's ranges and those of families of synthetic people, drawn into one figure."""

from pathlib import Path

import numpy as np

from studio.evaluation.operator_ranges import Ranges
from studio.human.features import FEATURE_NAMES

ORDERS, UNITS = ("q", "q̇", "q̈"), ("m", "m/s", "m/s²")
COLOURS = ("#7fa8d6", "#d3e2f2")
REAL = "#c8553d"


def plot(families: dict[str, dict[str, Ranges]], path: Path) -> None:
    """Draw the ranges per family (two at most) and state: a row per state, a column per order, a
    stack of bars per feature, the last family's the widest."""
    import matplotlib

    matplotlib.use("Agg")
    import matplotlib.pyplot as plt

    order = _drawing_order()
    x = np.arange(len(order))
    first = next(iter(families.values()))
    widths = dict(zip(families, (0.7, 0.95) if len(families) > 1 else (0.9,), strict=True))
    figure, axes = plt.subplots(
        len(first), 3, figsize=(17, 2.9 * len(first) + 1.5), sharex=True, squeeze=False
    )
    for row, state in zip(axes, first):
        for k, axis in enumerate(row):
            for (family, found), colour in reversed(list(zip(families.items(), COLOURS))):
                low, high = found[state].operator[k][:, order]
                axis.bar(x, high - low, widths[family], low, color=colour, label=family)
            low, high = first[state].real[k][:, order]
            axis.bar(x, high - low, 0.3, low, color=REAL, label="real people")
            shares = ", ".join(
                f"{family} {100 * found[state].coverage[k].mean():.0f} % "
                f"({100 * found[state].near[k]:.0f} %)"
                for family, found in families.items()
            )
            axis.set_title(f"{state}  {ORDERS[k]} [{UNITS[k]}]   {shares}", fontsize=9, loc="left")
            axis.grid(axis="y", alpha=0.3)
            axis.spines[["top", "right"]].set_visible(False)
            axis.tick_params(labelsize=7)
            axis.margins(x=0.01)
            for edge in _part_edges(order):
                axis.axvline(edge - 0.5, color="k", lw=0.4, alpha=0.4)
    for axis in axes[-1]:
        axis.set_xticks(x, [FEATURE_NAMES[i] for i in order], rotation=90, fontsize=5)
    axes[0, 0].legend(fontsize=8, loc="upper left", frameon=False, ncols=3)
    frames = ", ".join(f"{r.frames} {s}" for s, r in first.items())
    figure.suptitle(
        "Synthetic people beside real ones: 5th to 95th percentile of every feature\n"
        "in titles: share of the real range covered (of real frames near one of theirs); "
        "joints relative to the pelvis on the template's body\n"
        f"(height in leg lengths); real: labelled frames of the CMU and Kinect clips ({frames})",
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
