"""The pairs table of several seeds → models/mapper/README.md, between its two marks.

`a1-studio report pairs --seeds 0 1 2`
"""

import logging
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.evaluation.pairs import Options, run_pairs
from studio.files import write_whole

log = logging.getLogger(__name__)
BEGIN, END = "<!-- table: evaluate pairs -->", "<!-- end of table -->"
COLUMNS = {
    "joint_rmse_deg": ("joints (deg)", 1.0, 1),
    "orientation_error_deg": ("trunk (deg)", 1.0, 1),
    "foot_error_m": ("feet (cm)", 100.0, 1),
    "foot_skate_m_s": ("skate (m/s)", 1.0, 3),
    "contact_f1": ("contact F1", 1.0, 3),
    "fit_seconds": ("fitted in (s)", 1.0, 1),
}
"""Figure: heading, unit, decimals."""


@dataclass(frozen=True, kw_only=True)
class Report:
    """The pairs table of several seeds, put into a page between its two marks."""

    seeds: tuple[int, ...] = (0, 1, 2)
    """Of data, people held out and networks alike."""
    episodes: int = 12
    """Held-out performances of 10 s a state and seed."""
    steps: int = 1200
    """Gradient steps a state."""
    out: Path = Path("models/mapper/README.md")
    """The page."""


def report(config: Report) -> dict[str, Any]:
    """Make the rows and put their table into the file; StudioError if it has no place for it."""
    rows: list[dict[str, Any]] = []
    for seed in config.seeds:
        options = Options(episodes=config.episodes, seed=seed, steps=config.steps)
        rows += run_pairs(options)["rows"]
    text = config.out.read_text()
    if BEGIN not in text or END not in text:
        raise StudioError(f"{config.out} has no place for the table: {BEGIN} … {END}")
    marked = re.compile(f"{re.escape(BEGIN)}.*{re.escape(END)}", re.DOTALL)
    made = f"{BEGIN}\n{config.steps} gradient steps a state. {table(rows)}\n{END}"
    write_whole(config.out, marked.sub(made, text))
    return {"page": str(config.out), "rows": rows}


def table(rows: Sequence[dict[str, Any]]) -> str:
    """Markdown: a line per state and case, mean over seeds, ± half the spread of the joints'."""
    seeds = sorted({row["seed"] for row in rows})
    commits = ", ".join(sorted({str(row["commit"]) for row in rows}))
    said = f"Seeds {', '.join(map(str, seeds))}; commit {commits}"
    lines = [
        f"{said}; mean over seeds, joints ± half the range." if len(seeds) > 1 else f"{said}.",
        "",
        "| state | method | pairs | " + " | ".join(name for name, _, _ in COLUMNS.values()) + " |",
        "|" + "---|" * (3 + len(COLUMNS)),
    ]
    for state, case in dict.fromkeys((row["state"], row["case"]) for row in rows):
        those = [row for row in rows if (row["state"], row["case"]) == (state, case)]
        cells = []
        for key, (_, unit, digits) in COLUMNS.items():
            values = unit * np.array([row[key] for row in those])
            several = key == "joint_rmse_deg" and len(values) > 1
            spread = f" ± {np.ptp(values) / 2:.1f}" if several else ""
            cells.append(f"{values.mean():.{digits}f}{spread}")
        pairs = f"{round(np.mean([row['pairs'] for row in those])):,}"
        lines.append(f"| {state} | {_method(case)} | {pairs} | {' | '.join(cells)} |")
    return "\n".join(lines)


def _method(case: str) -> str:
    name, _, more = case.partition(", ")
    name = name.replace("_", " ")
    if more.endswith("pairs"):
        return name
    return f"shipped {name}" + (f", {more}" if more else "")
