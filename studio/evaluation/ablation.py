"""What each part of the recipe is worth: consistency at test time, and policies trained without.

The paper's bar chart. Test time: the shipped policies on disturbed references, with contact and
temporal consistency switched off in turn. Training: second policies at 3 million samples, each
with one thing changed (`studio/training/variants.py`); `full` is the recipe stopped there.

    a1-studio evaluate ablation
    a1-studio evaluate ablation --figure models/policy/ablation.png      (and draws the chart)
"""

from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, cast

import numpy as np
from numpy.typing import NDArray

from studio.control.policy import MODELS
from studio.control.state_machine import SPEED_LIMIT
from studio.evaluation.contenders import Contender, baseline, contender, trained
from studio.evaluation.disturbed import disturbed
from studio.evaluation.options import PolicyOptions
from studio.evaluation.tracking import CACHE, Job, Motions, compare, library, names_of
from studio.reference.intent import STATES, StateName
from studio.reference.stances import JOINT_SPEED
from studio.rl.bank import MotionBank
from studio.training.variants import VARIANTS, weights

CONSISTENCY = {
    "both": (True, True),
    "no_contact_consistency": (False, True),
    "no_temporal_consistency": (True, False),
    "neither": (False, False),
}
"""Contact, temporal."""
SLOW_LIMIT = JOINT_SPEED["stand"]
"""rad/s: the paper's for every motion; ours is 900 deg/s walking, so walking is tried at both."""
TRAINED: StateName = "walk"
"""The state whose variants are trained: the one that asks most of a policy."""


@dataclass(frozen=True, kw_only=True)
class Options(PolicyOptions):
    """Of `evaluate ablation`."""

    states: tuple[StateName, ...] = STATES
    """Whose shipped policies meet the disturbed references."""
    figure: Path | None = None
    """Also draw the rows as bars into this file (.png)."""


def run_ablation(
    options: Options = Options(),
    *,
    models: Path = MODELS,
    cache: Path | None = CACHE,
    progress: bool = True,
) -> dict[str, Any]:
    """`{"rows": [...]}` as `tracking` has them, each with its `kind` (test or training) and
    `variant`. Variants that are not trained are left out."""
    settings = (options.episodes, options.seed, options.threads, cache, progress)
    rows = []
    for state in cast(list[StateName], names_of("state", options.states, STATES)):
        who = [baseline("pd_playback"), contender("policy", state, models)]
        jobs: list[Job] = [(state, each) for each in who if each is not None]
        for name, motions in _test_time(state).items():
            done = compare(jobs, *settings, motions)
            rows += [{"kind": "test", "variant": name, **row} for row in done]
    for name, who in trained_variants(models).items():
        done = compare([(TRAINED, who)], *settings)
        rows += [{"kind": "training", "variant": name, **row} for row in done]
    if options.figure is not None:
        draw_chart(rows, options.figure)
    return {"rows": rows}


def _test_time(state: StateName) -> dict[str, Motions]:
    """Each way of treating a disturbed reference: how its bank is drawn."""
    limits = {"": SPEED_LIMIT[state]}
    if SPEED_LIMIT[state] > 1.01 * SLOW_LIMIT:
        limits["_120_deg_s"] = SLOW_LIMIT
    ways: dict[str, Motions] = {}
    for suffix, limit in limits.items():
        for name, (contact, temporal) in CONSISTENCY.items():
            if suffix and not temporal:
                continue
            ways[name + suffix] = _treated(name + suffix, contact, limit if temporal else np.inf)
    return ways


def _treated(name: str, contact: bool, limit: float) -> Motions:
    def draw(state: StateName, num: int, seed: int, cache: Path | None) -> MotionBank:
        bank = first(library(state, num, seed, cache), num)
        return disturbed(bank, np.random.default_rng([seed, 3]), contact=contact, speed_limit=limit)

    draw.__name__ = name
    return draw


def first(bank: MotionBank, num: int) -> MotionBank:
    """The first `num` motions of a bank."""
    arrays = {k: v[:num] for k, v in vars(bank).items() if isinstance(v, np.ndarray)}
    return replace(bank, **cast(dict[str, NDArray[Any]], arrays))


def trained_variants(models: Path = MODELS) -> dict[str, Contender]:
    """The second policies that are there, by name; "monolithic" among them."""
    places = {name: weights(TRAINED, name, models) for name in VARIANTS}
    places["monolithic"] = weights("all", "full", models)
    return {name: trained(name, path) for name, path in places.items() if path.exists()}


def draw_chart(rows: list[dict[str, Any]], out: Path) -> Path:
    """Bars of success and tracked time with their intervals: test time left, training right."""
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot as plt

    kinds = [k for k in ("test", "training") if any(r["kind"] == k for r in rows)]
    figure, axes = plt.subplots(1, len(kinds), figsize=(7.5 * len(kinds), 5.0), squeeze=False)
    for axis, kind in zip(axes[0], kinds, strict=True):
        chosen = [
            r for r in rows if r["kind"] == kind and (kind != "test" or r["controller"] == "policy")
        ]
        place = np.arange(len(chosen))
        for k, (name, colour) in enumerate(
            (("success_time_ratio", "#2a6f97"), ("tracked_time_ratio", "#f4a259"))
        ):
            value = np.array([r[name] for r in chosen])
            low, high = np.array([r[f"{name}_ci"] for r in chosen]).T
            axis.barh(
                place + 0.2 - 0.4 * k,
                value,
                0.38,
                xerr=np.maximum([value - low, high - value], 0.0),
                color=colour,
                label=name.replace("_", " "),
            )
        labels = [f"{r['state']}: {r['variant'].replace('_', ' ')}" for r in chosen]
        axis.set_yticks(place, labels if kind == "test" else [x.split(": ")[1] for x in labels])
        axis.invert_yaxis()
        axis.set_xlim(min(0.5, min(r["tracked_time_ratio"] for r in chosen) - 0.05), 1.0)
        axis.grid(axis="x", alpha=0.3)
        axis.spines[["top", "right"]].set_visible(False)
        title = {
            "test": "Shipped policies, disturbed references",
            "training": "Walking, trained 3 M samples",
        }
        axis.set_title(title[kind])
    figure.legend(
        *axes[0][0].get_legend_handles_labels(), loc="lower center", ncols=2, frameon=False
    )
    figure.tight_layout(rect=(0.0, 0.05, 1.0, 1.0))
    figure.savefig(out, dpi=130)
    plt.close(figure)
    return out
