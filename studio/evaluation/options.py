"""Options that tables share; each table adds its own to them, beside it."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True, kw_only=True)
class TableOptions:
    """What every table takes."""

    seed: int = 0
    """Everything drawn follows from it."""


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
class AllOptions:
    """Every table; each takes those of these options that it has, else its own."""

    seed: int = 0
    """Everything drawn follows from it."""
    episodes: int | None = None
    """Episodes a row (default: each table's own)."""
    threads: int | None = None
    """Cores to use (default: each table's own)."""
    clips: Path | None = None
    """Folder of real motion clips; without it the tables that need one are left out."""
