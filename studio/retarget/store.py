"""Where trained experts live on disk, and how they are read: models/mapper/<style>/."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from safetensors.numpy import load_file

from studio.carried import carried
from studio.errors import StudioError, unknown_name
from studio.retarget.mapper import Mapper
from studio.retarget.selector import Prototypes
from studio.retarget.states import EXPERTS

STYLES: tuple[str, ...] = ("march", "circles", "semantic")
"""Which human motion means walking: marching in place, circling hands, or manual features."""

MODELS = carried("models")
"""The shipped weights."""


@dataclass(frozen=True, kw_only=True)
class Experts:
    """Everything a Retargeter needs from disk. sidecars: what each file was made from."""

    style: str
    mappers: dict[str, Mapper]
    prototypes: Prototypes
    sidecars: dict[str, dict[str, Any]]


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
    return read_experts(style_dir(style, models), style)


def read_experts(folder: Path, style: str) -> Experts:
    """The three experts and the selector of a folder; StudioError if one is missing."""
    mappers = {name: Mapper.from_tensors(_tensors(folder / name, style)) for name in EXPERTS}
    prototypes = Prototypes.from_tensors(_tensors(folder / "selector", style))
    sidecars = {name: read_sidecar(folder / name) for name in (*EXPERTS, "selector")}
    return Experts(style=style, mappers=mappers, prototypes=prototypes, sidecars=sidecars)


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
