"""The table of `evaluate baselines` as last made → models/BASELINES.md: verdicts, figures, limits.

`a1-studio evaluate baselines && a1-studio report baselines`
"""

import json
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.evaluation.baselines import EXPERT
from studio.evaluation.registry import KEPT
from studio.evaluation.report_tables import Column, Row, Rows
from studio.files import write_whole
from studio.retarget.baselines.registry import RIVALS

REAL_TIME_MS = 10.0
"""The paper's: inference under 10 ms."""
UPRIGHT = 0.95
"""Success from which the policy counts as able to follow a mapper."""
FLEXIBLE = 1.25
"""Fitted to the other style a mapper errs by at most this factor more, and less than who stands."""
COLUMNS = (
    Column(key="state", head="state"),
    Column(key="controller", head="mapper"),
    Column(key="dimensions", head="D", places=0),
    Column(key="pairs_needed", head="pairs needed", places=0),
    Column(key="fit_seconds", head="fitted s"),
    Column(key="inference_p50_ms", head="p50 ms", places=3),
    Column(key="inference_p99_ms", head="p99 ms"),
    Column(key="inference_ratio", head="p50, times the expert's", places=1),
    Column(key="mapped_joint_rmse_deg", head="joints °", places=1),
    Column(key="joint_rmse_deg", head="planted °", places=1),
    Column(key="foot_error_m", head="feet cm", scale=100.0, places=1),
    Column(key="foot_skate_m_s", head="skate m/s", places=3),
    Column(key="lag_ms", head="lag ms", places=0),
    Column(key="net_distance_m", head="went m"),
    Column(key="net_distance_true_m", head="of m"),
    Column(key="worst_joint_rmse_deg", head="worst performance °", places=1),
    Column(key="other_style_rmse_deg", head="circles °", places=1),
    Column(key="success_time_ratio", head="success"),
    Column(key="tracked_time_ratio", head="tracked"),
    Column(key="robot_lag_ms", head="robot's lag ms", places=0),
    Column(key="falls", head="falls", places=0),
    Column(key="mean_time_between_falls_s", head="s between falls", places=0),
)
PAPER: dict[str, dict[str, str]] = {
    "Mapping dimension": dict(zip("ABCD", ("2D", "3D", "3D", "3D"))) | {"": "3D"},
    "Real-time": dict(zip("ABCD", "YNNY")) | {"": "Y"},
    "Dynamics": dict(zip("ABCD", "YNYN")) | {"": "Y"},
    "Mapping flexibility": dict(zip("ABCD", "NNNY")) | {"": "Y"},
    "Sim2Real": dict(zip("ABCD", "NNNN")) | {"": "Y"},
}
"""Its table: criterion, then rival by letter; "" is its own method."""


@dataclass(frozen=True, kw_only=True)
class Report:
    """The page of the rivals, of the table as last made."""

    out: Path = Path("models/BASELINES.md")
    """The page."""
    tables: Path = KEPT
    """Folder of the tables that `evaluate` keeps."""


def report(config: Report) -> dict[str, Any]:
    """Write the page. StudioError where the table is not made yet."""
    file = config.tables / "baselines.json"
    if not file.is_file():
        raise StudioError(f"no {file} yet: `a1-studio evaluate baselines` makes it")
    rows = json.loads(file.read_text())
    write_whole(config.out, page(rows), parents=True)
    return {"page": str(config.out), "rows": len(rows)}


INTRODUCTION = """# The mapper beside its rivals

By `a1-studio evaluate baselines` at {commit}, seed {seed}: all are fitted to the same pairs of
synthetic people ({pairs:,} of the first state) and scored on strangers who move otherwise,
{episodes} episodes of 10 s; `a1-studio report baselines` writes this page. Every method is ours
after its paper; what of each is kept is said in its file in `studio/retarget/baselines/`.

## The paper's table: what it says; what was measured
"""
VERDICTS = f"""
Dimension: 2D where hips, roll and yaw do not move. Real-time: p99 of a frame under
{REAL_TIME_MS:.0f} ms (fitting aside: B wants whole clips for it). Dynamics: the shipped policy,
which follows it under Table I, stays up for {UPRIGHT:.0%} of the time in every state that it maps;
how much of what was meant comes of it is *tracked*. Flexibility: fitted to circling hands instead
of marching, at most {FLEXIBLE} times the joint error, and less than standing still. Sim2Real: we
have no robot.

## All figures
"""
FIGURES = """
Pairs needed: the fewest, of whole performances of some 150, that do within 10 % of the best (of
these C takes 40, GMR one). Times are the processor's. Joints: as mapped, before contact and
temporal consistency; planted: after both. Lag: of what is mapped, behind the labels. Went: from the
first place to the last, of what was meant. Tracked: the robot's feet within 8 cm and its trunk
within 15° of what was meant. Falls: of people who drive under Table I, with the shipped experts in
the other states; a dash where no fall was seen.

## What each is given, what it refuses, where it fails
"""


def page(rows: Rows) -> str:
    """Markdown."""
    lines = [
        INTRODUCTION.format(**rows[0]),
        *_verdicts(rows),
        VERDICTS,
        "| " + " | ".join(c.head for c in COLUMNS) + " |",
        "|---" * len(COLUMNS) + "|",
        *(f"| {' | '.join(c.cell(row) for c in COLUMNS)} |" for row in rows if not row["refused"]),
        FIGURES,
        *_limits(rows),
    ]
    return "\n".join(lines) + "\n"


def _of(rows: Rows, name: str) -> Rows:
    return [row for row in rows if row["controller"] == name and not row["refused"]]


def verdicts(rows: Rows, name: str) -> dict[str, str]:
    """Criterion: what was measured of a mapper."""
    own = _of(rows, name)
    if not own:
        return dict.fromkeys(PAPER, "–")
    slowest = max(row["inference_p99_ms"] for row in own)
    success = [row["success_time_ratio"] for row in own if "success_time_ratio" in row]
    stays = f"{_yes(min(success) >= UPRIGHT)}, {min(success):.2f}" if success else "–"
    return {
        "Mapping dimension": f"{max(row['dimensions'] for row in own)}D",
        "Real-time": f"{_yes(slowest < REAL_TIME_MS)}, {slowest:.1f} ms",
        "Dynamics": stays,
        "Mapping flexibility": _flexible(rows, name),
        "Sim2Real": "not measured",
        "States": ", ".join(row["state"] for row in own),
        "Tracked, least": f"{min(row.get('tracked_time_ratio', 0.0) for row in own):.2f}",
    }


def _flexible(rows: Rows, name: str) -> str:
    walk = next((row for row in _of(rows, name) if row["state"] == "walk"), None)
    still = next((row for row in _of(rows, "stand_still") if row["state"] == "walk"), None)
    if walk is None or still is None:
        return "–"
    other = walk.get("other_style_rmse_deg")
    if other is None:
        return "N, refuses"
    within = other <= FLEXIBLE * walk["mapped_joint_rmse_deg"]
    return f"{_yes(within and other < still['other_style_rmse_deg'])}, {other:.1f}°"


def _yes(true: bool) -> str:
    return "Y" if true else "N"


def _verdicts(rows: Rows) -> list[str]:
    who = {rival.letter: name for name, rival in RIVALS.items() if rival.letter} | {"": EXPERT}
    heads = [f"({letter}) {name}" if letter else "ours" for letter, name in who.items()]
    found = {letter: verdicts(rows, name) for letter, name in who.items()} | {
        "gmr": verdicts(rows, "gmr")
    }
    lines = [f"| | {' | '.join((*heads, 'after GMR'))} |", "|---" * (len(heads) + 2) + "|"]
    for what in dict.fromkeys((*PAPER, *found[""])):
        cells = [
            f"{PAPER[what][letter]}; {found[letter].get(what, '–')}"
            if what in PAPER
            else found[letter].get(what, "–")
            for letter in who
        ]
        lines.append(f"| {what} | {' | '.join((*cells, found['gmr'].get(what, '–')))} |")
    return lines


def _limits(rows: Rows) -> list[str]:
    lines = []
    for name in dict.fromkeys(row["controller"] for row in rows):
        title = RIVALS[name].title if name in RIVALS else "ours"
        given = next(row["given"] for row in rows if row["controller"] == name)
        lines.append(
            f"- **{name}** ({title}). Given: {given}. {_ends(name)}{_worst(_of(rows, name))}"
        )
        refused = [row for row in rows if row["controller"] == name and row["refused"]]
        lines += [f"  - {row['state']}: refused. {row['refused']}" for row in refused]
    return lines


def _ends(name: str) -> str:
    """A rival's limits, as its file says them."""
    said = RIVALS[name].says("Limits") if name in RIVALS else ""
    return said + " " if said else ""


def _worst(rows: Rows) -> str:
    """A mapper's worst performance among its states."""
    if not rows:
        return ""
    row: Row = max(rows, key=lambda each: each["worst_joint_rmse_deg"])
    off, way = row["worst_joint_rmse_deg"], row["worst_net_distance_m"]
    true = row["worst_net_distance_true_m"]
    went = f", {way:.2f} m gone where {true:.2f} were meant" if row["state"] == "walk" else ""
    return (
        f"Its worst performance, {row['state']} {row['worst_clip']}: joints {off:.1f}° off{went}."
    )
