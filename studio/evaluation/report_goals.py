"""What the policies are to reach, and how the rows of a table are judged by it."""

from collections.abc import Callable
from dataclasses import dataclass

from studio.evaluation.report_tables import TRACKING, Column, Row, Rows
from studio.reference.intent import STATES, StateName
from studio.rl.transitions import SOURCES


@dataclass(frozen=True, kw_only=True)
class Goal:
    """table, who: the rows it is about. worst: of those rows, the figure to be judged.

    A robot that fell in any of them misses it.
    """

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
        fell = any(r.get("survived") is False for r in rows)
        met = value >= self.limit if self.at_least else value <= self.limit
        sign = "≥" if self.at_least else "≤"
        found = f"{value:.3g}{self.unit}" + (", fell" if fell else "")
        return _line(self.words, f"{sign} {self.limit:g}{self.unit}", found, met and not fell)


@dataclass(frozen=True, kw_only=True)
class Beats:
    """The policy's tracking of a state against PD playback's, by their 95 % intervals.

    Better by more than both intervals. Of what is `higher` and PD has FULL of already, it must
    only not be worse by so much.
    """

    state: str
    column: Column
    higher: bool = False

    def line(self, tables: dict[str, Rows]) -> str | None:
        """A row of the page; None while either's row is not made."""
        rows = {r["controller"]: r for r in tables.get("tracking", []) if r["state"] == self.state}
        if not {"policy", "pd_playback"} <= rows.keys():
            return None
        policy, pd = rows["policy"], rows["pd_playback"]
        (low, high), (pd_low, pd_high) = self._interval(policy), self._interval(pd)
        if self.higher and float(pd[self.column.key]) >= FULL:
            word, met = "not below", high >= pd_low
        elif self.higher:
            word, met = "above", low > pd_high
        else:
            word, met = "below", high < pd_low
        words = f"{self.state} against PD: {self.column.head}"
        return _line(words, f"{word} {self.column.cell(pd)}", self.column.cell(policy), met)

    def _interval(self, row: Row) -> tuple[float, float]:
        value = row[self.column.key]
        low, high = row.get(f"{self.column.key}_ci", (value, value))
        return float(low), float(high)


FULL = 0.99
"""Share of the time from which on there is nothing left to gain."""


def _line(words: str, goal: str, found: str, met: bool) -> str:
    return f"| {words} | {goal} | {found} | {'yes' if met else '**no**'} |"


def _policy(*states: str) -> Callable[[Row], bool]:
    return lambda r: r["controller"] == "policy" and (not states or r.get("state") in states)


def _least(key: str) -> Callable[[Rows], float]:
    return lambda rows: min(float(r[key]) for r in rows)


def _most(key: str, scale: float = 1.0) -> Callable[[Rows], float]:
    return lambda rows: max(scale * float(r[key]) for r in rows)


def _furthest(asked: str, held: str) -> Callable[[Rows], float]:
    return lambda rows: max(abs(float(r[asked]) - float(r[held])) for r in rows)


def _range_off(rows: Rows) -> float:
    """Of one axis: how far the range held, from one side to the other, is off the range asked."""
    ends = [min(rows, key=_commanded), max(rows, key=_commanded)]
    asked, held = (
        float(ends[1][key]) - float(ends[0][key]) for key in ("commanded_deg", "achieved_deg")
    )
    return abs(asked - held)


def _commanded(row: Row) -> float:
    return float(row["commanded_deg"])


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


def _means(row: Row, means: str) -> bool:
    return row["controller"] == "policy" and row["means"] == means


def _walking(
    means: str, words: str, figure: Callable[[Rows], float], limit: float, unit: str
) -> Goal:
    return Goal(
        words=words,
        table="walk",
        who=lambda r: _means(r, means),
        worst=figure,
        limit=limit,
        at_least=False,
        unit=unit,
    )


_STILL = ("stand", "sit")
_TILT = _furthest("commanded_deg", "achieved_deg")
_SPEED = _furthest("commanded_m_s", "achieved_m_s")
_SIDE = _furthest("commanded_side_m_s", "achieved_side_m_s")
_TURN = _furthest("commanded_deg_s", "achieved_deg_s")
SIT_RANGES = {"pitch": (30, 4.0), "roll": (15, 4.0), "yaw": (7, 3.5)}
"""Degrees asked, and how far off it may be: never more than half, or standing still would do."""


def _sit_range(axis: str) -> Goal:
    asked, limit = SIT_RANGES[axis]
    return Goal(
        words=f"sit {axis}, {asked}° of range, off by",
        table="tilt",
        who=lambda r: r["controller"] == "policy" and (r["state"], r["axis"]) == ("sit", axis),
        worst=_range_off,
        limit=limit,
        at_least=False,
        unit="°",
    )


def _entering(goal: str, source: str) -> Goal:
    """Judged by whom the live controller lets do it: the policy, or PD playback."""
    return Goal(
        words=f"from {source} to {goal}, success",
        table="transitions",
        who=lambda r: bool(r.get("in_charge")) and (r["from"], r["to"]) == (source, goal),
        worst=_least("success_time_ratio"),
        limit=0.95,
        at_least=True,
    )


def _staying_up(words: str, dynamics: str, limit: float) -> Goal:
    """Of the rows that have a goal: those for comparison have none."""
    return Goal(
        words=words,
        table="endurance",
        who=lambda r: r.get("goal") is not None and r["dynamics"] == dynamics,
        worst=_most("falls_per_hour"),
        limit=limit,
        at_least=False,
        unit=" an hour",
    )


_COLUMNS = {c.key: c for c in TRACKING}


def _against_pd(state: StateName) -> list[Beats]:
    lower = ("joint_rmse_deg", "foot_error_m", "orientation_error_deg", "velocity_error_m_s")
    shares = ("success_time_ratio", "tracked_time_ratio")
    return [
        *(Beats(state=state, column=_COLUMNS[k], higher=True) for k in shares),
        *(Beats(state=state, column=_COLUMNS[k]) for k in lower),
    ]


GOALS: tuple[Goal | Beats, ...] = (
    _on("tracking", "success time, every state", (), _least("success_time_ratio"), 0.99, True),
    _on(
        "tracking", "tracked time, stand and sit", _STILL, _least("tracked_time_ratio"), 0.95, True
    ),
    _on("tracking", "tracked time, walk", ("walk",), _least("tracked_time_ratio"), 0.90, True),
    _on("tracking", "joints, stand and sit", _STILL, _most("joint_rmse_deg"), 4.0, False, "°"),
    _on("tracking", "joints, walk", ("walk",), _most("joint_rmse_deg"), 5.0, False, "°"),
    _on("tracking", "feet", (), _most("foot_error_m", 100.0), 3.0, False, " cm"),
    *(beats for state in STATES for beats in _against_pd(state)),
    *(_entering(goal, source) for goal, sources in SOURCES.items() for source in sources),
    _on("tilt", "stand ±40° on each axis, off by", ("stand",), _TILT, 4.0, False, "°"),
    *map(_sit_range, SIT_RANGES),
    _on("reach", "a paw sitting", ("sit",), _least("paw_m"), 0.8, True, " m"),
    _on("reach", "a paw standing (must fail)", ("stand",), _most("paw_m"), 0.8, False, " m"),
    _walking("march", "speeds 0 to 0.97 m/s, off by", _SPEED, 0.1, " m/s"),
    _walking("march", "turns of ±15°/s, off by", _TURN, 3.0, "°/s"),
    _walking("through space", "backward and turning, off by", _SPEED, 0.1, " m/s"),
    _walking("through space", "sideways, off by", _SIDE, 0.1, " m/s"),
    _walking("through space", "turns of ±30 and ±60°/s, off by", _TURN, 6.0, "°/s"),
    Goal(
        words="drift, of the way",
        table="walk",
        who=lambda r: _means(r, "march") and r["drift_share"] is not None,
        worst=_most("drift_share", 100.0),
        limit=5.0,
        at_least=False,
        unit=" %",
    ),
    _on("kicks", "kicks survived", (), _least("survived"), 0.95, True),
    _on("workspace", "workspace with tilts over without", (), _least("ratio"), 2.5, True),
    _staying_up("no fall, nominal dynamics: worst row", "nominal", 0.0),
    _staying_up("falls an hour, Table I: worst row", "table_i", 1.0),
)
