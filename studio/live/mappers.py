"""Mappers trained from one's own takes: which there are, which is in use, and the way back."""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.control.command import PuppeteerConfig
from studio.errors import StudioError, unknown_name
from studio.live.commands import SetMapper, SetStyle
from studio.retarget.store import Experts, load_experts, read_experts
from studio.takes.names import check_name

FOLDER, SIDECAR = "mappers", "mapper.json"


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

    def as_dict(self) -> dict[str, Any]:
        """The key `mapper` of GET /api/state: name, style, and the name before, if there is one."""
        return {
            "name": self.now.name or "shipped",
            "style": self.now.experts.style,
            "before": None if self.before is None else self.before.name or "shipped",
        }


def mapper_folder(sessions: Path, name: str) -> Path:
    """Where a mapper of this name is, or would be."""
    return Path(sessions) / FOLDER / check_name(name, "mapper")


def list_mappers(sessions: Path) -> list[dict[str, Any]]:
    """The sidecar of every trained mapper, the newest last; unfinished ones are left out."""
    found = []
    for path in (Path(sessions) / FOLDER).glob(f"*/{SIDECAR}"):
        try:
            about = json.loads(path.read_text())
            found.append({**about, "name": path.parent.name})
        except (OSError, ValueError, TypeError):
            continue
    return sorted(found, key=lambda about: str(about.get("made", "")))


def open_mapper(
    sessions: Path, config: PuppeteerConfig, mappers: Mappers, command: SetMapper | SetStyle
) -> OpenedMapper:
    """Read what `command` asks for, on the caller's thread. StudioError if there is no such."""
    if isinstance(command, SetStyle):
        return OpenedMapper(name=None, experts=load_experts(command.style))
    if command.back:
        if mappers.before is None:
            raise StudioError("there is no mapper to go back to: none was swapped in yet")
        return mappers.before
    if command.name is None or command.name == "shipped":
        return OpenedMapper(name=None, experts=load_experts(config.style))
    folder = mapper_folder(sessions, command.name)
    if not (folder / SIDECAR).is_file():
        known = ["shipped", *(about["name"] for about in list_mappers(sessions))]
        raise unknown_name("mapper", command.name, known)
    style = str(json.loads((folder / SIDECAR).read_text()).get("style", config.style))
    return OpenedMapper(name=command.name, experts=read_experts(folder, style))
