"""What a mapper is worth beside the expert, off line: errors, lag, time a frame, pairs it needs."""

import time
from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio import metrics
from studio.errors import StudioError
from studio.evaluation.pairs import score
from studio.reference.intent import StateName
from studio.reference.stances import tilt_of
from studio.retarget.mapper import Expert, Mapped
from studio.robot.a1 import CONTROL_DT
from studio.training.operator_pairs import PairSet

Array = NDArray[np.float64]
Fit = Callable[[PairSet], Expert]

LONGEST_LAG = 15
"""Control periods (0.5 s) up to which a lag is looked for."""
PERFORMANCES = (1, 4, 16)
"""How many of the performances it is fitted to when what it needs is looked for."""
ENOUGH = 1.1
"""It has pairs enough where its error is within this factor of its best."""
STILL, PLANAR = 0.02, 0.05
"""Shares of the true motion under which a mapper moves nothing, and nothing out of the plane."""
TIMED = 400
"""Frames that are timed."""


def errors(state: StateName, clips: Sequence[PairSet], mapped: Sequence[Mapped]) -> dict[str, Any]:
    """Means over performances of the pairs table's figures, of the lag and of the dimension; and
    of the worst performance, which of them and its error."""
    each = [score(state, [clip], [said]) for clip, said in zip(clips, mapped, strict=True)]
    worst = int(np.argmax([row["joint_rmse_deg"] for row in each]))
    names = (
        "joint_rmse_deg", "mapped_joint_rmse_deg", "orientation_error_deg", "foot_error_m",
        "foot_skate_m_s", "contact_f1", "net_distance_m", "net_distance_true_m",
    )  # fmt: skip
    space = dimensions(state, clips, mapped)
    late = float(np.mean([_lag(clip, said) for clip, said in zip(clips, mapped, strict=True)]))
    return {
        **{name: float(np.mean([row[name] for row in each])) for name in names},
        "lag_ms": 1000.0 * CONTROL_DT * late if space else None,
        "dimensions": space,
        "worst_clip": worst,
        "worst_joint_rmse_deg": each[worst]["joint_rmse_deg"],
        "worst_net_distance_m": each[worst]["net_distance_m"],
        "worst_net_distance_true_m": each[worst]["net_distance_true_m"],
    }


def _lag(clip: PairSet, said: Mapped) -> int:
    return metrics.lag_periods(said.joint_pos, clip.joint_pos, LONGEST_LAG)


def dimensions(state: StateName, clips: Sequence[PairSet], mapped: Sequence[Mapped]) -> int:
    """3 where hips, roll or yaw move, 2 where only the rest does, 0 where nothing moves."""

    def moved(pick: Callable[[Array, Array], Array]) -> float:
        said = [pick(m.joint_pos, m.base_quat).std(axis=0) for m in mapped]
        true = [
            pick(c.joint_pos.astype(float), c.base_quat.astype(float)).std(axis=0) for c in clips
        ]
        return float(np.linalg.norm(said) / max(float(np.linalg.norm(true)), 1e-9))

    if moved(lambda joints, quat: joints) < STILL:
        return 0
    aside = moved(
        lambda joints, quat: np.concatenate([joints[:, 0::3], tilt_of(state, quat)[:, ::2]], axis=1)
    )
    return 2 if aside < PLANAR else 3


def inference_ms(expert: Expert, triplet: NDArray) -> tuple[float, float]:
    """Median and 99th percentile of a frame, ms of processor time (neighbours do not count), live:
    one triplet (3F,) after another."""
    begun = expert.begin()
    rows = np.asarray(triplet[:TIMED], np.float64)
    took = []
    for row in rows:
        began = time.thread_time()
        begun(row)
        took.append(time.thread_time() - began)
    return float(1e3 * np.median(took)), float(1e3 * np.percentile(took, 99.0))


def pairs_needed(fit: Fit, known: PairSet, held: Sequence[PairSet], whole: Expert) -> int:
    """The fewest pairs, of whole performances, that do ENOUGH on `held`; `whole`, fitted to all of
    `known`, is among those tried."""
    clips = np.unique(known.clip)
    tried: list[tuple[int, float]] = []
    for count in (n for n in PERFORMANCES if n < len(clips)):
        part = known.take(np.isin(known.clip, _spread(clips, count)))
        try:
            tried.append((len(part), bare_rmse(fit(part), held)))
        except StudioError:
            continue  # too few to fit at all
    tried.append((len(known), bare_rmse(whole, held)))
    best = min(error for _, error in tried)
    return next(pairs for pairs, error in tried if error <= ENOUGH * best)


def bare_rmse(expert: Expert, held: Sequence[PairSet]) -> float:
    """RMS joint error, degrees, of what is mapped, before it is planted."""
    squares = [np.mean((expert(clip.triplet).joint_pos - clip.joint_pos) ** 2) for clip in held]
    return metrics.rms_deg(float(np.mean(squares)))


def _spread(clips: NDArray, count: int) -> NDArray:
    return clips[np.linspace(0, len(clips) - 1, count).round().astype(int)]
