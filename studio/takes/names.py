"""Names of takes to their folders: no name from outside leaves the sessions folder."""

import re
from pathlib import Path

from studio.errors import StudioError

RESERVED = ("datasets", "mappers", "deleted")
"""Folders beside the takes that are none, and what the API answers under /api/takes/ itself."""
_NAME = re.compile(r"[A-Za-z0-9_-]{1,120}\Z")


def check_name(name: object, kind: str = "take") -> str:
    """`name` itself if it matches [A-Za-z0-9_-]+ (at most 120), else a StudioError."""
    if not isinstance(name, str) or not _NAME.match(name):
        raise StudioError(
            f"{str(name)[:60]!r} is no name for a {kind}: use letters, digits, _, - (at most 120)"
        )
    return name


def check_take(name: object) -> str:
    """`name` itself if a new take may be called so, else a StudioError."""
    fit = check_name(name)
    if fit.lower() in RESERVED:  # some file systems take both for one
        raise StudioError(f"{fit} is no name for a take: {', '.join(RESERVED)} are kept for others")
    if fit.startswith("-"):
        raise StudioError(f"{fit} is no name for a take: a command would take it for an option")
    return fit


def fit_name(name: str, otherwise: str = "take") -> str:
    """A name from outside as one that fits: what does not becomes "-", what is too long is cut."""
    fit = re.sub(r"[^A-Za-z0-9_-]+", "-", name).strip("-")[:100] or otherwise
    return f"{fit}-take" if fit.lower() in RESERVED else fit


def slug(label: str) -> str:
    """A label as part of a name: what does not fit becomes "-"."""
    return re.sub(r"[^A-Za-z0-9_]+", "-", label).strip("-")[:60]


def take_folder(root: Path, name: object) -> Path:
    """The folder of a take, which need not exist; a link to elsewhere is refused."""
    folder = root / check_name(name)
    if folder.name.lower() in RESERVED:
        check_take(name)
    if folder.is_symlink():
        raise StudioError(f"take {name} is a link to somewhere else: copy the folder itself")
    return folder
