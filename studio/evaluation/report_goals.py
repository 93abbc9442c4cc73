"""What the policies are to reach, and how the rows of a table are judged by it."""

from collections.abc import Callable
from dataclasses import dataclass

from studio.evaluation.report_tables import Row, Rows


@dataclass(frozen=True, kw_only=True)
class Goal:
    """table, who: the rows it is about. worst: of those rows, the figure to be judged."""

    words: str
    table: str
    who: Callable[[Row], bool]
    worst: Callable[[Rows], float]
    limit: float
    at_least: bool
    unit: str = ""

    def line(self, tables: dict[str, Rows]) -> str | None:
        """A row of the page; None while its table is not made."""
        rows = [r for r in tables.get(self.table, []) if self.who(r)]
        if not rows:
            return None
        value = self.worst(rows)
        met = value >= self.limit if self.at_least else value <= self.limit
        sign = "≥" if self.at_least else "≤"
        found = f"{value:.3g}{self.unit}"
        cells = (self.words, f"{sign} {self.limit:g}{self.unit}", found, "yes" if met else "**no**")
        return "| " + " | ".join(cells) + " |"


def _policy(*states: str) -> Callable[[Row], bool]:
    return lambda r: r["controller"] == "policy" and (not states or r.get("state") in states)


def _least(key: str) -> Callable[[Rows], float]:
    return lambda rows: min(float(r[key]) for r in rows)


def _most(key: str, scale: float = 1.0) -> Callable[[Rows], float]:
    return lambda rows: max(scale * float(r[key]) for r in rows)


def _furthest(asked: str, held: str) -> Callable[[Rows], float]:
    return lambda rows: max(abs(float(r[asked]) - float(r[held])) for r in rows)


def _on(
    table: str,
    words: str,
    states: tuple[str, ...],
    figure: Callable[[Rows], float],
    limit: float,
    at_least: bool,
    unit: str = "",
) -> Goal:
    return Goal(
        words=words,
        table=table,
        who=_policy(*states),
        worst=figure,
        limit=limit,
        at_least=at_least,
        unit=unit,
    )


_STILL = ("stand", "sit")
_TILT = _furthest("reference_deg", "achieved_deg")
_SPEED = _furthest("commanded_m_s", "achieved_m_s")
_TURN = _furthest("commanded_deg_s", "achieved_deg_s")
GOALS = (
    _on("tracking", "success time, every state", (), _least("success_time_ratio"), 0.99, True),
    _on(
        "tracking", "tracked time, stand and sit", _STILL, _least("tracked_time_ratio"), 0.95, True
    ),
    _on("tracking", "tracked time, walk", ("walk",), _least("tracked_time_ratio"), 0.90, True),
    _on("tracking", "joints, stand and sit", _STILL, _most("joint_rmse_deg"), 4.0, False, "°"),
    _on("tracking", "joints, walk", ("walk",), _most("joint_rmse_deg"), 5.0, False, "°"),
    _on("tracking", "feet", (), _most("foot_error_m", 100.0), 3.0, False, " cm"),
    _on("tilt", "stand ±40° on each axis, off by", ("stand",), _TILT, 4.0, False, "°"),
    _on("tilt", "sit 30, 15, 7° of range, off by", ("sit",), _TILT, 4.0, False, "°"),
    _on("reach", "a paw sitting", ("sit",), _least("paw_m"), 0.8, True, " m"),
    _on("reach", "a paw standing (must fail)", ("stand",), _most("paw_m"), 0.8, False, " m"),
    _on("walk", "speeds 0 to 0.97 m/s, off by", (), _SPEED, 0.1, False, " m/s"),
    _on("walk", "turns of ±15°/s, off by", (), _TURN, 3.0, False, "°/s"),
    Goal(
        words="drift, of the way",
        table="walk",
        who=lambda r: r["controller"] == "policy" and r["drift_share"] is not None,
        worst=_most("drift_share", 100.0),
        limit=5.0,
        at_least=False,
        unit=" %",
    ),
    _on("kicks", "kicks survived", (), _least("survived"), 0.95, True),
    _on("workspace", "workspace with tilts over without", (), _least("ratio"), 2.5, True),
)
