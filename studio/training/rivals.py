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
from studio.training.synthetic_pairs import make_pairs

log = logging.getLogger(__name__)
OURS, SHIPPED = "expert", "shipped"
"""The shipped experts' name among mappers, and beside those that were trained here."""
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
    experts: dict[StateName, Expert] = {
        each: _of_people(name, each, style, seconds) for each in STATES if state in ("auto", each)
    }
    return in_place(shipped, experts, name)


def open_willing(
    name: str, style: str, seconds: float = SECONDS
) -> tuple[Experts, dict[StateName, str]]:
    """As `open_mapper`, but the shipped experts stay in the states that the mapper refuses: those,
    and why. StudioError where it refuses all."""
    experts: dict[StateName, Expert] = {}
    refused: dict[StateName, str] = {}
    _fit_of(name)
    for state in STATES:
        try:
            experts[state] = _of_people(name, state, style, seconds)
        except StudioError as why:
            refused[state] = str(why)
    if not experts:
        raise StudioError(f"mapper {name!r} maps no state: {next(iter(refused.values()))}")
    return in_place(load_experts(style), experts, name), refused


def _of_people(name: str, state: StateName, style: str, seconds: float) -> Expert:
    log.info("fitting %s to synthetic people: %s", name, state)
    return fitted(name, state, make_pairs(state, seconds, 0, style))


def refuse_taken(name: str) -> None:
    """StudioError where a mapper trained here may not be called so."""
    if name in (OURS, SHIPPED, *RIVALS):
        raise StudioError(f"{name} comes with the studio: choose another name for the mapper")


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
