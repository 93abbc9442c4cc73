"""Where trained experts live on disk, and how they are read: models/mapper/<style>/."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

import msgspec
import numpy as np
from safetensors import SafetensorError
from safetensors.numpy import load_file

from studio.errors import StudioError, unknown_name
from studio.human.features import FEATURE_DIM
from studio.options import STYLES
from studio.paths import package_folder
from studio.retarget.experts import EXPERTS
from studio.retarget.mapper import Expert, Mapper, misfit
from studio.retarget.selector import Prototypes
from studio.retarget.semantic import SemanticWalk
from studio.takes.untrusted import Name, read_json

STRIDE_GAIN: dict[str, float] = {"march": 1.75, "circles": 1.4}
"""Times the strides of a style's shipped network, an average over people who step unlike. Driven by
people it has not seen, the simulated robot then goes as fast as they mean (`evaluate styles`)."""
BASE_STYLE = "march"
"""Styles differ in walking only: whatever a style has no weights of its own for is as in this one.
So standing and sitting are the same weights in all, and "semantic" shares the selector too."""

MODELS = package_folder("models")
"""The shipped weights."""


class _Sidecar(msgspec.Struct):
    """The types of what others read from a sidecar; more may be in it."""

    made: Name = ""
    style: Name | None = None
    states: list[Name] = []
    takes: list[Name] = []


_about = msgspec.json.Decoder(dict[str, Any])


@dataclass(frozen=True, kw_only=True)
class Experts:
    """Everything a Retargeter needs from disk. sidecars: what each file was made from."""

    style: str
    mappers: dict[str, Expert]
    prototypes: Prototypes
    sidecars: dict[str, dict[str, Any]]

    @property
    def stride_gain(self) -> float:
        """Times the strides that the walk network says; one's own network is taken at its word."""
        own = "dataset" in self.sidecars.get("walk", {})
        return 1.0 if own else STRIDE_GAIN.get(self.style, 1.0)


def style_dir(style: str, models: Path | None = None) -> Path:
    """The folder of one style's experts. StudioError for a style that is not known."""
    if style not in STYLES:
        raise unknown_name("style", style, STYLES)
    root = models or MODELS
    if not root.is_dir():
        raise StudioError(f"no folder {root.name} with experts: run from a checkout or reinstall")
    return root / "mapper" / style


def load_experts(style: str = "march", models: Path | None = None) -> Experts:
    """One style's three experts and selector; StudioError says how to train what is missing."""
    return read_experts(style_dir(style, models), style, models)


def read_experts(folder: Path, style: str, models: Path | None = None) -> Experts:
    """The three experts and the selector of a folder; StudioError if one is missing.

    models: where the weights are that the style shares with others.
    """
    stems = {name: stem(folder, name, style, models) for name in (*EXPERTS, "selector")}
    mappers: dict[str, Expert] = {
        name: SemanticWalk()
        if ruled(name, style)
        else _tried(stems[name], style, Mapper.from_tensors, _maps)
        for name in EXPERTS
    }
    prototypes = _tried(stems["selector"], style, Prototypes.from_tensors, _selects)
    sidecars = {name: read_sidecar(path) for name, path in stems.items()}
    return Experts(style=style, mappers=mappers, prototypes=prototypes, sidecars=sidecars)


def ruled(part: str, style: str) -> bool:
    """Whether rules take the place of weights."""
    return style == "semantic" and part == "walk"


def shared(part: str, style: str) -> bool:
    """Whether a part (a state, or "selector") of a style may be that of BASE_STYLE."""
    return style != BASE_STYLE and (style == "semantic" or part in ("stand", "sit"))


def stem(folder: Path, part: str, style: str, models: Path | None = None) -> Path:
    """Path without suffix of a part's weights: in `folder`, or where the style shares them."""
    own = folder / part
    if own.with_suffix(".safetensors").is_file() or not shared(part, style):
        return own
    return style_dir(BASE_STYLE, models) / part


def read_sidecar(stem: Path) -> dict[str, Any]:
    """The JSON beside weights: data, seed, commit, held-out scores; {} if there is none.

    Raises StudioError for one that is damaged, or whose words are not of the types we read.
    """
    path = stem.with_suffix(".json")
    if not path.exists():
        return {}
    try:
        about = read_json(path, _about)
        msgspec.convert(about, _Sidecar)
        return about
    except (OSError, ValueError) as error:
        raise _damaged(path, error) from error


Part = TypeVar("Part")


def _tried(
    stem: Path,
    style: str,
    make: Callable[[dict[str, Any]], Part],
    fits: Callable[[Part], bool],
) -> Part:
    """A part read from its weights, which give finite answers of the right shape: else the robot
    would be stopped by them later. StudioError names the file."""
    path = stem.with_suffix(".safetensors")
    if not path.is_file():
        raise StudioError(
            f"no trained {stem.name} for style {style!r} ({path.name} is missing): run "
            f"`a1-studio train mapper --style {style}`"
        )
    try:
        with np.errstate(all="ignore"):
            part = make(load_file(path))
            if not fits(part):
                raise ValueError("its answers are not finite, or of another shape")
    except (SafetensorError, OSError, LookupError, ValueError, TypeError, StudioError) as error:
        raise _damaged(path, error) from error
    return part


def _maps(expert: Mapper) -> bool:
    return not misfit(expert(np.zeros(3 * FEATURE_DIM)))


def _selects(prototypes: Prototypes) -> bool:
    point = prototypes.embed(np.zeros(3 * FEATURE_DIM))
    labels, distances = prototypes.nearest(point, 1)
    return len(labels) == 1 and bool(np.isfinite(distances).all()) and prototypes.p99 > 0.0


def _damaged(path: Path, error: Exception) -> StudioError:
    return StudioError(
        f"{path.parent.name}/{path.name} cannot be used ({error}): train it again, or choose "
        "another mapper"
    )
