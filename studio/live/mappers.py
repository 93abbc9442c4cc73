"""Mappers trained from one's own takes: which there are, which is in use, and the way back."""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.errors import StudioError, unknown_name
from studio.live.state_parts import MapperInUse
from studio.retarget.store import Experts, read_experts, read_sidecar
from studio.takes.names import check_name

FOLDER, SIDECAR = "mappers", "mapper.json"
SHIPPED = "shipped"
"""The name of those that come with the studio."""


@dataclass(frozen=True, kw_only=True)
class OpenedMapper:
    """Experts read from disk; name None: the shipped ones."""

    name: str | None
    experts: Experts


class Mappers:
    """Remembers the mapper in use and the one before it. The loop's thread changes it."""

    def __init__(self, experts: Experts) -> None:
        self.now = OpenedMapper(name=None, experts=experts)
        self.before: OpenedMapper | None = None

    def swap(self, mapper: OpenedMapper) -> None:
        """Use `mapper`; what was in use can be gone back to."""
        self.before, self.now = self.now, mapper

    def as_dict(self) -> MapperInUse:
        """The key `mapper` of GET /api/state."""
        return {
            "name": self.now.name or SHIPPED,
            "style": self.now.experts.style,
            "before": None if self.before is None else self.before.name or SHIPPED,
        }


def mapper_folder(sessions: Path, name: str) -> Path:
    """Where a mapper of this name is, or would be."""
    return Path(sessions) / FOLDER / check_name(name, "mapper")


def list_mappers(sessions: Path) -> list[dict[str, Any]]:
    """The sidecar of every trained mapper, the newest last; unfinished ones are left out."""
    found = []
    for path in (Path(sessions) / FOLDER).glob(f"*/{SIDECAR}"):
        try:
            found.append({**read_sidecar(path.with_suffix("")), "name": path.parent.name})
        except StudioError:
            continue
    return sorted(found, key=lambda about: str(about.get("made", "")))


def open_mapper(sessions: Path, name: str, style: str) -> OpenedMapper:
    """Read a trained mapper, on the caller's thread. style: of one that does not say its own.

    StudioError if there is none of that name, or it is damaged.
    """
    folder = mapper_folder(sessions, name)
    if not (folder / SIDECAR).is_file():
        known = [SHIPPED, *(about["name"] for about in list_mappers(sessions))]
        raise unknown_name("mapper", name, known)
    style = read_sidecar((folder / SIDECAR).with_suffix("")).get("style") or style
    return OpenedMapper(name=name, experts=read_experts(folder, style))
