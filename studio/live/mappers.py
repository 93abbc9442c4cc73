"""Mappers of one's own and rivals: which there are, which is in use, and the way back."""

from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from studio.errors import StudioError, unknown_name
from studio.live.fitting import Fitting
from studio.live.state_parts import MapperInUse
from studio.reference.intent import StateName
from studio.retarget.baselines.registry import RIVALS
from studio.retarget.store import Experts, load_experts, read_experts, read_sidecar
from studio.takes.names import check_name
from studio.training.rivals import OURS, SHIPPED, open_willing

FOLDER, SIDECAR = "mappers", "mapper.json"


@dataclass(frozen=True, kw_only=True)
class OpenedMapper:
    """Experts read from disk, or fitted; name None: the shipped ones. refused: the states that the
    shipped ones map in a rival's place, and why."""

    name: str | None
    experts: Experts
    refused: dict[StateName, str] = field(default_factory=dict)


class Mappers:
    """Remembers the mapper in use and the one before it. The loop's thread changes it."""

    def __init__(self, experts: Experts) -> None:
        self.now = OpenedMapper(name=None, experts=experts)
        self.before: OpenedMapper | None = None
        self.fitting = Fitting()
        """Of rivals; any thread."""
        self.given: OpenedMapper | None = None
        """Of a file of one's own, named when the studio was begun."""

    def swap(self, mapper: OpenedMapper) -> None:
        """Use `mapper`; what was in use can be gone back to."""
        self.before, self.now = self.now, mapper

    def as_dict(self) -> MapperInUse:
        """The key `mapper` of GET /api/state."""
        return {
            "name": self.now.name or SHIPPED,
            "style": self.now.experts.style,
            "before": None if self.before is None else self.before.name or SHIPPED,
            "refused": dict(self.now.refused),
            "fitting": self.fitting.name,
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


def is_own(sessions: Path, name: str) -> bool:
    """Whether a mapper of this name was trained here. StudioError for what is no name."""
    return (mapper_folder(sessions, name) / SIDECAR).is_file()


def is_rival(sessions: Path, name: str) -> bool:
    """Whether this names a rival; one's own of the same name, trained before there were any, comes
    first."""
    return name in RIVALS and not is_own(sessions, name)


def list_rivals(sessions: Path) -> list[dict[str, str]]:
    """The rivals by name, with what each is, is given and cannot do."""
    return [
        {
            "name": name,
            "letter": rival.letter,
            "title": rival.title,
            "given": rival.given,
            "source": rival.says("Source"),
            "limits": rival.says("Limits"),
        }
        for name, rival in RIVALS.items()
        if is_rival(sessions, name)
    ]


def open_chosen(sessions: Path, name: str, style: str, mappers: Mappers) -> OpenedMapper:
    """Any mapper that a page may choose, on the caller's thread, a rival fitted in a process of its
    own. StudioError says what would work."""
    if name == SHIPPED:
        return OpenedMapper(name=None, experts=load_experts(style))
    if mappers.given is not None and name == mappers.given.name:
        return mappers.given
    if is_rival(sessions, name):
        experts, refused = mappers.fitting.fitted(name, style)
        return OpenedMapper(name=name, experts=experts, refused=refused)
    return open_mapper(sessions, name, style)


def open_given(sessions: Path, name: str, style: str, mappers: Mappers) -> OpenedMapper:
    """The mapper that `serve --mapper` names: any of `open_chosen`, or FILE.py:Class, which can be
    chosen by that name from now on. StudioError says what would work."""
    if ":" not in name:
        return open_chosen(sessions, SHIPPED if name == OURS else name, style, mappers)
    experts, refused = open_willing(name, style)
    mappers.given = OpenedMapper(name=name, experts=experts, refused=refused)
    return mappers.given


def open_mapper(sessions: Path, name: str, style: str) -> OpenedMapper:
    """Read a trained mapper, on the caller's thread. style: of one that does not say its own.

    StudioError if there is none of that name, or it is damaged.
    """
    folder = mapper_folder(sessions, name)
    if not is_own(sessions, name):
        known = [SHIPPED, *(about["name"] for about in list_mappers(sessions)), *RIVALS]
        raise unknown_name("mapper", name, known)
    style = read_sidecar((folder / SIDECAR).with_suffix("")).get("style") or style
    return OpenedMapper(name=name, experts=read_experts(folder, style))
