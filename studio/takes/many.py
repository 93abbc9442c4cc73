"""Many takes at once: each is done by itself, and those that are refused say why."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Literal

from studio.errors import StudioError
from studio.takes import bin
from studio.takes.edit.review import review
from studio.takes.session_library import SessionLibrary

Action = Literal["keep", "reject", "undecided", "delete"]
VERDICTS = {"keep": True, "reject": False, "undecided": None}


@dataclass(kw_only=True)
class Outcome:
    """done: names, in order. refused: {name: why}. binned: of deleted ones, where in the bin they
    lie (as `bin` takes them)."""

    done: list[str] = field(default_factory=list)
    refused: dict[str, str] = field(default_factory=dict)
    binned: list[str] = field(default_factory=list)


def act(sessions: Path, names: Iterable[str], action: Action) -> Outcome:
    """Give takes a verdict, or throw them into the bin."""
    library, out = SessionLibrary(sessions), Outcome()

    def one(name: str) -> None:
        if action == "delete":
            out.binned.append(library.delete(name).name)
        else:
            library.edit(name, keep=VERDICTS[action])

    return _each(out, names, one)


def act_in_bin(
    sessions: Path, places: Iterable[str], action: Literal["restore", "delete"]
) -> Outcome:
    """Bring takes back from the bin, or delete them for good; done: as they were asked for."""
    work = bin.bring_back_from if action == "restore" else bin.delete_for_good
    return _each(Outcome(), places, lambda place: work(Path(sessions), place))


def scores(sessions: Path, names: Iterable[str]) -> tuple[dict[str, float], dict[str, str]]:
    """Each take's score, given it now where it had none; and why others have none."""
    library, found = SessionLibrary(sessions), dict[str, float]()

    def one(name: str) -> None:
        known = library.info(name).score
        found[name] = review(library, name).score if known is None else known

    return found, _each(Outcome(), names, one).refused


def _each(out: Outcome, names: Iterable[str], work: Callable[[str], object]) -> Outcome:
    for name in dict.fromkeys(names):
        try:
            work(name)
        except StudioError as error:
            out.refused[name] = str(error)
        else:
            out.done.append(name)
    return out
