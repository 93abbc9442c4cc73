"""Where trained experts live on disk, and how they are read: models/mapper/<style>/."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors.numpy import load_file

from studio.errors import StudioError, unknown_name
from studio.paths import carried
from studio.retarget.mapper import Expert, Mapper
from studio.retarget.selector import Prototypes
from studio.retarget.semantic import SemanticWalk
from studio.retarget.states import EXPERTS

STYLES: tuple[str, ...] = ("march", "circles", "semantic")
"""Which human motion means walking: marching in place, circling hands, or marching in place read by
rule (`semantic`)."""
STRIDE_GAIN: dict[str, float] = {"march": 1.75, "circles": 1.4}
"""Times the strides of a style's shipped network, an average over people who step unlike. Driven by
people it has not seen, the simulated robot then goes as fast as they mean (`evaluate styles`)."""
BASE_STYLE = "march"
"""Styles differ in walking only: whatever a style has no weights of its own for is as in this one.
So standing and sitting are the same weights in all, and "semantic" shares the selector too."""

MODELS = carried("models")
"""The shipped weights."""


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
        else Mapper.from_tensors(_tensors(stems[name], style))
        for name in EXPERTS
    }
    prototypes = Prototypes.from_tensors(_tensors(stems["selector"], style))
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
    """The JSON beside a weights file: data, seed, commit, held-out scores; {} if there is none."""
    path = stem.with_suffix(".json")
    return json.loads(path.read_text()) if path.is_file() else {}


def _tensors(stem: Path, style: str) -> dict[str, Any]:
    path = stem.with_suffix(".safetensors")
    if not path.is_file():
        raise StudioError(
            f"no trained {stem.name} for style {style!r} ({path.name} is missing): run "
            f"`a1-studio train mapper --style {style}`"
        )
    return load_file(path)
