"""Seconds of synthetic people's pairs: what experts, and all they are compared with, are fitted to.

Without torch, so that whoever fits a rival need not load it.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from studio.reference.intent import StateName
from studio.retarget.experts import EXPERTS
from studio.timing import CONTROL_HZ
from studio.training.operator_pairs import PairSet, performances


def make_pairs(
    state: StateName,
    seconds: float,
    seed: int,
    style: str = "march",
    family: str = "default",
    tick: Callable[[int], Any] | None = None,
) -> PairSet:
    """`seconds` of one state's pairs by ever new people of a family; the same for the same seed."""
    rng = np.random.default_rng([seed, list(EXPERTS).index(state)])
    parts: list[PairSet] = []
    frames = 0
    for pairs in performances(state, rng, seconds, family=family, style=style):
        parts.append(pairs)
        frames += len(pairs)
        if tick:
            tick(min(int(frames / CONTROL_HZ), int(seconds)))
    return PairSet.join(parts)
