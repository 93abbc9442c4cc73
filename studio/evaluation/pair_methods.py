"""Training pairs of the three states to every method of the pairs table, at a number of pairs.

What is fitted at 76, 250 and 522 pairs sees frames spread evenly over the same performances, as key
poses would be chosen. An expert and the monolithic network have one budget: the monolithic one
maps all three states, has the weights of three experts together, and their pairs and gradient
steps together.
"""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import partial

import numpy as np

from studio.reference.intent import StateName
from studio.retarget.baselines.frames import FrameMapper, Targets
from studio.retarget.baselines.simple import NearestPair, Ridge
from studio.retarget.mapper import NUM_OUTPUTS, Mapper
from studio.training.mapper_fit import MapperTraining, fit_expert, new_net
from studio.training.mapper_net import MapperNet
from studio.training.operator_pairs import PairSet

SIZES = (76, 250, 522)
"""Pairs a state: the paper's fewest and most, and between. All there are come after them."""
CONTACT_HIDDEN = 64


@dataclass(frozen=True, kw_only=True)
class Fitted:
    """A method for a state, fitted to `pairs` pairs in all in `fit_seconds`."""

    controller: str
    method: FrameMapper
    pairs: int
    fit_seconds: float


def spread(pairs: PairSet, count: int | None) -> PairSet:
    """`count` of the pairs, evenly over all performances; all of them for None."""
    if count is None or count >= len(pairs):
        return pairs
    return pairs.take(np.linspace(0, len(pairs) - 1, count).round().astype(int))


def fit_methods(
    known: Mapping[StateName, PairSet], training: MapperTraining
) -> dict[StateName, list[Fitted]]:
    """Nearest pair, ridge, expert and monolithic for each state, on the same pairs.

    training: of one expert; the monolithic network has as many steps for each state.
    """
    mono = _timed("monolithic", partial(monolithic, known, training))
    total = sum(len(pairs) for pairs in known.values())
    out: dict[StateName, list[Fitted]] = {}
    for state, pairs in known.items():
        targets = Targets.of(pairs)
        makers: dict[str, Callable[[], FrameMapper]] = {
            "nearest_pair": partial(NearestPair, pairs.triplet, targets),
            "ridge": partial(Ridge, pairs.triplet, targets),
            "expert": partial(expert, state, pairs, training),
        }
        fitted = [replace(_timed(name, make), pairs=len(pairs)) for name, make in makers.items()]
        out[state] = [*fitted, replace(mono, pairs=total)]
    return out


def expert(state: StateName, pairs: PairSet, training: MapperTraining) -> Mapper:
    """A state's expert from scratch."""
    return _exported(fit_expert(state, pairs, training))


def monolithic(known: Mapping[StateName, PairSet], training: MapperTraining) -> Mapper:
    """One network for all states: the experts' weights, pairs and steps together."""
    joined = PairSet.join(list(known.values()))
    width = joined.triplet.shape[1]
    settings = replace(training, steps=training.steps * len(known))
    like = new_net("stand", joined, settings)
    net = MapperNet(
        *(getattr(like, n).numpy() for n in ("mean", "scale", "rate_scale", "neutral_quat")),
        hidden=widened(training.hidden, 3, width, NUM_OUTPUTS, len(known)),
        contact_hidden=widened(CONTACT_HIDDEN, 2, 2 * width // 3, 4, len(known)),
        seed=training.seed,
    )
    return _exported(fit_expert("stand", joined, settings, net=net))


def widened(hidden: int, layers: int, inputs: int, outputs: int, times: int) -> int:
    """The width at which one network has about as many weights as `times` of width `hidden`.

    Weights of `layers` hidden layers: h (inputs + 1) + (layers - 1) h (h + 1) + outputs (h + 1).
    """
    squares, linear = layers - 1, inputs + 1 + layers - 1 + outputs
    wanted = times * (squares * hidden**2 + linear * hidden)
    return round((np.sqrt(linear**2 + 4 * squares * wanted) - linear) / (2 * squares))


def _timed(controller: str, make: Callable[[], FrameMapper]) -> Fitted:
    began = time.perf_counter()
    method = make()
    seconds = time.perf_counter() - began
    return Fitted(controller=controller, method=method, pairs=0, fit_seconds=round(seconds, 2))


def _exported(net: MapperNet) -> Mapper:
    return Mapper.from_tensors(net.export())
