"""Folders of real motion: their clips, and what a careful person would expect of each stretch."""

import json
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.reference.intent import STATES
from studio.sources import FILES

LABELS = "labels.json"
"""Per file, intervals in seconds with the expert expected: {"from", "to", "expert"}."""


def clips_below(folder: Path) -> list[Path]:
    """What can be driven in a folder and below it, in order of their names."""
    files = (p for p in folder.rglob("*") if p.suffix.lower() in FILES and p.is_file())
    return sorted(p for p in files if p.name != LABELS)


def read_labels(folder: Path) -> dict[str, list[dict[str, Any]]]:
    """Clip file name -> its intervals, of the clips that are there.

    StudioError where there is no LABELS to read, it labels nothing that is there, or by an expert
    that there is not.
    """
    try:
        labels = json.loads((folder / LABELS).read_text())
    except (OSError, ValueError) as error:
        raise StudioError(f"no {LABELS} to read in {folder}: {error}") from error
    present = {name: spans for name, spans in labels.items() if (folder / name).is_file()}
    if not present:
        raise StudioError(f"none of the clips that {folder}/{LABELS} names is in {folder}")
    experts = {span["expert"] for spans in present.values() for span in spans}
    if unknown := experts - {*STATES}:
        raise StudioError(f"{folder}/{LABELS}: no expert {unknown}, only {', '.join(STATES)}")
    return present
