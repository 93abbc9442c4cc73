"""Every table about the policies → one page with their goals, met or missed, for the repository.

    a1-studio evaluate all
    a1-studio report models/policy/SCORES.md

`evaluate` keeps each table as JSON as soon as it is made; the page shows them as last made. A page
that ends in .html is made with pictures and replays in it (`report_html`).
"""

import json
import os
import platform
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import tyro

from studio.errors import StudioError
from studio.evaluation.all import made_how
from studio.evaluation.registry import KEPT
from studio.evaluation.report_goals import GOALS
from studio.evaluation.report_tables import TABLES, Column, Rows
from studio.files import write_whole
from studio.paths import package_folder
from studio.training.machine import commit


def page(tables: dict[str, Rows], facts: str) -> str:
    """Markdown: goals first, then each table."""
    lines = ["# Scores of the shipped policies", "", facts, ""]
    lines += ["## Goals", "", "| what | goal | worst | met |", "|---|---|---|---|"]
    lines += [line for goal in GOALS if (line := goal.line(tables))]
    for name, rows in tables.items():
        if not rows:
            continue
        title, columns = _title(name, rows)
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
    """One page of the tables that `evaluate` has computed, goals met and missed first."""

    out: tyro.conf.Positional[Path] = Path("runs/evaluate/report.md")
    """The page: Markdown, or, where it ends in .html, one HTML page with JSON beside it."""
    tables: Path = KEPT
    """Folder of the tables that `evaluate` keeps."""
    committed: bool = False
    """Of the pages in models/, as they stand, instead: .html alone."""
    sessions: Path = Path("sessions")
    """Folder of recorded takes."""
    replays: tuple[str, ...] = ()
    """Takes that play in the HTML page, each in some 300 KB."""


COMMITTED = ("policy/SCORES.md", "BASELINES.md", "PEOPLE.md", "../docs/figures.md")
"""Of models/: the pages of what was measured."""
PICTURES = {
    "Ablation: success of policies with and without each consistency": "policy/ablation.png",
    "Workspace of the standing robot's right front paw, without tilts and with": (
        "policy/workspace.png"
    ),
    "Ranges of the synthetic people beside real clips": "operator_statistics.png",
    **{
        f"A person, what the robot should do, and what it does in physics: {words}": (
            f"report/strip_{task}_0.png"
        )
        for task, words in (
            ("tilt", "tilting"),
            ("manipulate_right", "reaching with a paw"),
            ("walk", "walking"),
            ("sit_manipulate", "reaching with both, sitting"),
        )
    },
}


def make(config: Report) -> dict[str, Any]:
    """Write the page: `{"page", "tables"}`, its file and what is on it. StudioError where no table
    is made yet."""
    html = config.out.suffix == ".html"
    if config.committed and not html:
        raise StudioError("--committed makes an HTML page: name one that ends in .html")
    models = package_folder("models")
    if config.committed:
        files = [(models / name).resolve() for name in COMMITTED]
        facts = (
            f"Of the repository's own pages at {commit()}: each says with which commit, seeds and "
            "machine it was measured."
        )
        return _as_html(config, facts, {file: file.read_text("utf-8") for file in files})
    tables = load(config.tables)
    if not tables:
        raise StudioError(f"no table in {config.tables} yet: `a1-studio evaluate all` makes them")
    facts = _facts(config.tables, tables)
    text = page(tables, facts)
    if html:
        return _as_html(config, facts, {config.out.with_suffix(".md"): text})
    write_whole(config.out, text, parents=True)
    return {"page": str(config.out), "tables": list(tables)}


def _as_html(config: Report, facts: str, pages: dict[Path, str]) -> dict[str, Any]:
    from studio.evaluation.report_html import Content, write_report

    pictures = {caption: package_folder("models") / name for caption, name in PICTURES.items()}
    content = Content(
        facts=facts,
        pages=pages,
        pictures=pictures if config.committed else {},
        sessions=config.sessions,
        replays=config.replays,
    )
    return write_report(config.out, content)


def _facts(folder: Path, tables: dict[str, Rows]) -> str:
    """Commit, machine, seeds, and the hours of those tables that `evaluate all` has made."""
    how = [made_how(folder, name) for name in tables]
    machine = next((f"{about['cpu']}, " for about in how if "cpu" in about), "")
    seeds = sorted({str(row["seed"]) for rows in tables.values() for row in rows if "seed" in row})
    seconds = sum(about.get("seconds", 0.0) for about in how)
    hours = f"; {seconds / 3600.0:.1f} hours" if seconds else ""
    where = f"{machine}{os.cpu_count()} cores, {platform.machine()}"
    seeded = f"; seeds {', '.join(seeds)}" if seeds else ""
    return f"By `a1-studio report` at {commit()}; {where}{seeded}{hours}."


def load(folder: Path) -> dict[str, Rows]:
    """The tables made so far: those of the policies first, in their order, then the others.

    Their figures are in the units that their names end in.
    """
    found = {file.stem: json.loads(file.read_text()) for file in sorted(folder.glob("*.json"))}
    order = [name for name in TABLES if name in found]
    return {name: found[name] for name in (*order, *(n for n in found if n not in TABLES))}


def _title(name: str, rows: Rows) -> tuple[str, Sequence[Column]]:
    """Heading and columns; of a table without columns of its own, every figure of its rows."""
    if name in TABLES:
        return TABLES[name]
    keys = dict.fromkeys(key for row in rows for key, value in row.items() if _shown(key, value))
    return name.replace("_", " ").capitalize(), [
        Column(key=key, head=key.replace("_", " "), places=3) for key in keys
    ]


def _shown(key: str, value: Any) -> bool:
    return key not in ("commit", "seed", "episodes", "table") and not isinstance(value, list | dict)
