"""Options that tables share; each table adds its own to them, beside it."""

from dataclasses import dataclass
from pathlib import Path

from studio.errors import StudioError


@dataclass(frozen=True, kw_only=True)
class TableOptions:
    """What every table takes."""

    seed: int = 0
    """Everything drawn follows from it."""
    episodes: int | None = None
    """Episodes a row; each table says of what, and how many unless told (default: its own)."""

    def __post_init__(self) -> None:
        refuse_none(self.episodes)


def refuse_none(episodes: int | None) -> None:
    """StudioError for a table of no episodes, which would take the place of one that tells."""
    if episodes is not None and episodes < 1:
        raise StudioError("an evaluation needs --episodes of at least 1")


@dataclass(frozen=True, kw_only=True)
class PolicyOptions(TableOptions):
    """Of a table that compares controllers over many episodes."""

    episodes: int = 1024
    """Episodes a row."""
    threads: int = 0
    """Cores to use; 0: all."""


@dataclass(frozen=True, kw_only=True)
class ScriptOptions(TableOptions):
    """Of a table that plays scripts: the same each time but for what the seed draws."""

    episodes: int = 1
    """How often each script is played, with the seeds from `seed` on: a row each."""


@dataclass(frozen=True, kw_only=True)
class AllOptions(TableOptions):
    """Every table; each takes those of these options that it has, else its own."""

    threads: int | None = None
    """Cores to use (default: each table's own)."""
    clips: Path | None = None
    """Folder of real motion clips; without it the tables that need one are left out."""
    fresh: bool = False
    """Make anew also those that are kept, made by the same code with the same options."""
    smoke: bool = False
    """Each at its smallest, in minutes and kept apart: whether all runs, not what is worth."""
