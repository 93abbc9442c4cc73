"""`--mapper NAME`: a rival, or anybody's own, fitted to synthetic people, in the experts' place.

A mapper of one's own is a class with `fit(state, pairs, seed)`, which gives what
`retarget.mapper.Expert` asks for (docs/mapper_plugin.py is one), named as FILE.py:Class or
module:Class.
"""

import importlib
import importlib.util
import logging
import sys
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any

import numpy as np

from studio.errors import StudioError, unknown_name
from studio.human.features import FEATURE_DIM
from studio.reference.intent import STATES, StateName
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.mapper import Expert, misfit
from studio.retarget.store import Experts, load_experts
from studio.training.train_mapper import make_pairs

log = logging.getLogger(__name__)
OURS = "expert"
"""The shipped experts' name among mappers."""
SECONDS = 300.0
"""Of synthetic people a state that a rival is fitted to: some seconds of computing."""


def open_mapper(name: str, style: str, state: str = "auto", seconds: float = SECONDS) -> Experts:
    """The experts that a mapper's name means, fitted for `state`, or for all where it is "auto".

    StudioError for an unknown name, for a state that the mapper refuses, saying what would work,
    and for a mapper of one's own that does not do as an expert does.
    """
    shipped = load_experts(style)
    if name == OURS:
        return shipped
    fit = _fit_of(name)
    experts: dict[StateName, Expert] = {}
    for each in STATES:
        if state not in ("auto", each):
            continue
        log.info("fitting %s to synthetic people: %s", name, each)
        pairs = make_pairs(each, seconds, 0, style)
        experts[each] = _checked(name, fit(each, pairs, 0))
    return in_place(shipped, experts, name)


def in_place(shipped: Experts, experts: dict[StateName, Expert], name: str) -> Experts:
    """The shipped experts but for some; those are taken at their word (no longer strides)."""
    own = {state: {"dataset": name} for state in experts}
    return replace(
        shipped,
        mappers={**shipped.mappers, **experts},
        sidecars={**shipped.sidecars, **own},
    )


def _fit_of(name: str) -> Any:
    if name in RIVALS:
        return RIVALS[name].fit
    place, colon, member = name.rpartition(":")
    if not colon:
        raise unknown_name("mapper", name, (OURS, *RIVALS, "FILE.py:Class", "module:Class"))
    try:
        found = getattr(_module(place), member)
        return found.fit
    except (ImportError, OSError, SyntaxError, AttributeError) as error:
        raise StudioError(
            f"no mapper {name!r} ({error}): name FILE.py:Class or module:Class, a class with "
            "fit(state, pairs, seed), as docs/mapper_plugin.py has one"
        ) from error


def _module(place: str) -> ModuleType:
    if not place.endswith(".py"):
        return importlib.import_module(place)
    path = Path(place)
    spec = importlib.util.spec_from_file_location(path.stem, path)
    if spec is None or spec.loader is None:
        raise ImportError(f"{place} is no Python file")
    module = importlib.util.module_from_spec(spec)
    sys.modules[spec.name] = module  # dataclasses look their module up
    spec.loader.exec_module(module)
    return module


def _checked(name: str, expert: Any) -> Expert:
    """The expert, if it maps a frame as one must. StudioError says in what it does not."""
    try:
        said = expert.begin()(np.zeros(3 * FEATURE_DIM))
        known = isinstance(expert.remembers, bool)
        why = misfit(said) if known else "remembers must be a bool"
    except (AssertionError, AttributeError, TypeError, ValueError) as error:
        why = str(error) or type(error).__name__
    if why:
        raise StudioError(f"mapper {name!r} cannot drive ({why}): see retarget.mapper.Expert")
    return expert


def fitted(name: str, state: StateName, pairs: Pairs, seed: int = 0) -> Expert:
    """A rival, or a mapper of one's own, as a state's expert. StudioError as `open_mapper`."""
    return _checked(name, _fit_of(name)(state, pairs, seed))
