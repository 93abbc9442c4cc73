"""Every table about the policies → one page with their goals, met or missed, for the repository.

    python -m studio.evaluation.report models/policy/SCORES.md --episodes 1024

Each table is kept as JSON as soon as it is made: a run that was cut off goes on where it stopped,
and `--tables walk,kicks` makes some of them anew.
"""

import json
import logging
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import tyro

from studio.errors import unknown_name
from studio.evaluation.registry import run_evaluation
from studio.evaluation.report_goals import GOALS
from studio.evaluation.report_tables import TABLES, Rows
from studio.training.machine import commit

log = logging.getLogger(__name__)
PARTS = Path("runs/evaluate/report")


def page(tables: dict[str, Rows], facts: str) -> str:
    """Markdown: goals first, then each table."""
    lines = ["# Scores of the shipped policies", "", facts, ""]
    lines += ["## Goals", "", "| what | goal | worst | met |", "|---|---|---|---|"]
    lines += [line for goal in GOALS if (line := goal.line(tables))]
    for name, (title, columns) in TABLES.items():
        if not tables.get(name):
            continue
        rows = tables[name]
        lines += ["", f"## {title}", "", f"`a1-studio evaluate {name}`, {_episodes(rows)}.", ""]
        lines += ["| " + " | ".join(c.head for c in columns) + " |", "|---" * len(columns) + "|"]
        lines += ["| " + " | ".join(c.cell(row) for c in columns) + " |" for row in rows]
    return "\n".join(lines) + "\n"


def _episodes(rows: Rows) -> str:
    counts = [row.get("episodes", 1) for row in rows]
    few, many = min(counts), max(counts)
    if many == 1:
        return "one episode a case"
    return f"{many} episodes a row" if few == many else f"{few} to {many} episodes a row"


@dataclass(frozen=True, kw_only=True)
class Report:
    """out: the page. tables: which to make anew, by name; the others are as last made."""

    out: tyro.conf.Positional[Path]
    tables: str = ",".join(TABLES)
    episodes: int = 1024
    seed: int = 0
    parts: Path = PARTS


def make(config: Report) -> Path:
    """Make the tables, then the page from all that are there. StudioError for an unknown name."""
    for name in filter(None, config.tables.split(",")):
        if name not in TABLES:
            raise unknown_name("table", name, TABLES)
        log.info("%s", name)
        few = {"kicks": 256, "transitions": 256, "workspace": 64}
        count = min(config.episodes, few.get(name, config.episodes))
        rows = run_evaluation(name, episodes=count, seed=config.seed)["rows"]
        config.parts.mkdir(parents=True, exist_ok=True)
        (config.parts / f"{name}.json").write_text(json.dumps(rows))
    tables = load(config.parts)
    machine = f"{os.cpu_count()} cores, {platform.machine()}, no GPU"
    facts = f"By `python -m studio.evaluation.report` at {commit()}, seed {config.seed}; {machine}."
    config.out.write_text(page(tables, facts))
    return config.out


def load(parts: Path) -> dict[str, Rows]:
    """The tables made so far."""
    names: Sequence[str] = [n for n in TABLES if (parts / f"{n}.json").exists()]
    return {n: json.loads((parts / f"{n}.json").read_text()) for n in names}


if __name__ == "__main__":
    logging.basicConfig(level=logging.INFO, format="%(message)s")
    make(tyro.cli(Report))
