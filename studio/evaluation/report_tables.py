"""The tables of the policies' page: which figures of a row are shown, and how."""

from dataclasses import dataclass
from typing import Any

Row = dict[str, Any]
Rows = list[Row]


@dataclass(frozen=True, kw_only=True)
class Column:
    """key: of a row. head: of the column. scale: the value's factor. places: its digits.

    A row that has `KEY_ci` too shows it behind: 2.4 [2.3, 2.5].
    """

    key: str
    head: str
    scale: float = 1.0
    places: int = 2

    def cell(self, row: Row) -> str:
        value = row.get(self.key)
        if value is None:
            return "–"
        if isinstance(value, bool):
            return "yes" if value else "no"
        if isinstance(value, (int, float)):
            interval = row.get(f"{self.key}_ci")
            ends = f" [{', '.join(map(self._figure, interval))}]" if interval else ""
            return self._figure(value) + ends
        return str(value).replace("_", " ")

    def _figure(self, value: float) -> str:
        return f"{self.scale * value:.{self.places}f}"


_STATE, _WHO = Column(key="state", head="state"), Column(key="controller", head="controller")
_VARIANT = Column(key="variant", head="variant")
TRACKING = (
    Column(key="success_time_ratio", head="success", places=3),
    Column(key="tracked_time_ratio", head="tracked", places=3),
    Column(key="joint_rmse_deg", head="joints °", places=1),
    Column(key="foot_error_m", head="feet cm", scale=100.0, places=1),
    Column(key="orientation_error_deg", head="tilt °", places=1),
    Column(key="height_error_m", head="height cm", scale=100.0, places=1),
    Column(key="velocity_error_m_s", head="velocity m/s", places=3),
    Column(key="yaw_rate_error_deg_s", head="yaw °/s", places=1),
    Column(key="lag_ms", head="lag ms", places=0),
    Column(key="drift_m", head="drift m"),
    Column(key="foot_skate_m_s", head="skate m/s", places=3),
    Column(key="jerk_rad_s3", head="jerk rad/s³", places=0),
    Column(key="torque_saturation", head="saturated %", scale=100.0, places=1),
)
TABLES: dict[str, tuple[str, tuple[Column, ...]]] = {
    "tracking": ("Noisy references of 10 s, full Table I", (_STATE, _WHO, *TRACKING)),
    "transitions": (
        "Into each state from the others, full Table I",
        (
            Column(key="from", head="from"),
            Column(key="to", head="to"),
            _WHO,
            Column(key="in_charge", head="in charge"),
            *TRACKING[:5],
        ),
    ),
    "tilt": (
        "Tilts held, nominal dynamics",
        (
            _STATE,
            Column(key="axis", head="axis"),
            _WHO,
            Column(key="commanded_deg", head="asked °", places=1),
            Column(key="reference_deg", head="reference °", places=1),
            Column(key="achieved_deg", head="held °", places=1),
            Column(key="survived", head="survived"),
        ),
    ),
    "walk": (
        "Speeds and turns, nominal dynamics",
        (
            Column(key="case", head="asked"),
            _WHO,
            Column(key="commanded_m_s", head="reference m/s"),
            Column(key="achieved_m_s", head="robot m/s"),
            Column(key="commanded_side_m_s", head="reference to the left"),
            Column(key="achieved_side_m_s", head="robot"),
            Column(key="commanded_deg_s", head="reference °/s", places=1),
            Column(key="achieved_deg_s", head="robot °/s", places=1),
            Column(key="drift_share", head="drift % of the way", scale=100.0, places=0),
            Column(key="survived", head="survived"),
        ),
    ),
    "reach": (
        "A paw at 0.8 m, nominal dynamics",
        (
            _STATE,
            Column(key="paw", head="paw"),
            _WHO,
            Column(key="paw_m", head="height m"),
            Column(key="reached", head="reached"),
        ),
    ),
    "kicks": (
        "Kicks in any direction, nominal dynamics",
        (
            _STATE,
            _WHO,
            Column(key="kick_m_s", head="kick m/s", places=1),
            Column(key="survived", head="survived", places=3),
            Column(key="survived_unkicked", head="without", places=3),
        ),
    ),
    "workspace": (
        "Volume that the standing robot's right paw reaches",
        (
            _WHO,
            Column(key="volume_m3", head="litres", scale=1e3, places=1),
            Column(key="volume_tilt_m3", head="with tilts", scale=1e3, places=1),
            Column(key="ratio", head="ratio"),
        ),
    ),
    "ablation": (
        "Ablation: consistency at test time, walking policies of 3 million samples",
        (Column(key="kind", head="kind"), _STATE, _VARIANT, _WHO, *TRACKING[:7], TRACKING[11]),
    ),
    "curriculum": ("Curriculum", (_VARIANT, *TRACKING[:7])),
    "future": ("Without the future", (_VARIANT, *TRACKING[:9])),
    "endurance": (
        "Minutes of driving",
        (
            Column(key="source", head="source"),
            _WHO,
            Column(key="dynamics", head="dynamics"),
            Column(key="sensor", head="person seen by"),
            Column(key="holds", head="holds"),
            Column(key="steps", head="steps"),
            Column(key="max_joint_speed_deg_s", head="joints up to °/s", places=0),
            Column(key="episodes", head="people", places=0),
            Column(key="seconds", head="minutes", scale=1.0 / 60.0, places=0),
            Column(key="walking_s", head="walked at full speed", scale=1.0 / 60.0, places=0),
            Column(key="falls", head="falls", places=0),
            Column(key="falls_per_hour", head="falls an hour", places=1),
            Column(key="goal", head="goal", places=0),
            Column(key="speed_asked_m_s", head="asked m/s"),
            Column(key="speed_made_m_s", head="made m/s"),
        ),
    ),
    "link": (
        "Over a line that delays, jitters and loses, each way",
        (
            Column(key="level", head="sent"),
            Column(key="task", head="task"),
            Column(key="delay_ms", head="delay ms", places=0),
            Column(key="jitter_ms", head="jitter ms", places=0),
            Column(key="loss", head="loss %", scale=100.0, places=0),
            Column(key="episodes", head="people", places=0),
            Column(key="falls", head="falls", places=0),
            Column(key="success_time_ratio", head="success", places=3),
            Column(key="done", head="done"),
            Column(key="lag_ms", head="lag ms", places=0),
            Column(key="joint_rmse_deg", head="joints °", places=1),
            Column(key="orientation_error_deg", head="tilt °", places=1),
        ),
    ),
    "sim2sim": (
        "Exported policies in two engines",
        (
            Column(key="task", head="task"),
            Column(key="engine", head="engine"),
            _WHO,
            Column(key="episodes", head="people", places=0),
            Column(key="falls", head="falls", places=0),
            Column(key="success_time_ratio", head="success", places=3),
            Column(key="joint_rmse_deg", head="joints °", places=1),
            Column(key="orientation_error_deg", head="tilt °", places=1),
        ),
    ),
    "faults": (
        "A line that fails",
        (
            Column(key="case", head="frames"),
            Column(key="rate", head="share, or s late", places=2),
            Column(key="episodes", head="people", places=0),
            Column(key="seconds", head="minutes", scale=1.0 / 60.0, places=0),
            Column(key="falls", head="falls", places=0),
            Column(key="followed", head="followed", places=2),
            Column(key="refused_share", head="refused", places=2),
            Column(key="joint_rmse_deg", head="joints °", places=1),
        ),
    ),
    "response": (
        "How late a person is followed",
        (
            Column(key="case", head="movement"),
            Column(key="kind", head="people"),
            Column(key="stage", head="stage"),
            Column(key="max_joint_speed_deg_s", head="joints up to °/s", places=0),
            Column(key="episodes", head="n", places=0),
            Column(key="behind_ms", head="behind ms", places=0),
            Column(key="onset_ms", head="onset ms", places=0),
            Column(key="clipped", head="speed limit cuts", places=2),
        ),
    ),
    "latency": (
        "How late a camera's frame is",
        (
            Column(key="case", head="section"),
            Column(key="frames", head="frames", places=0),
            Column(key="p50_ms", head="p50 ms", places=1),
            Column(key="p95_ms", head="p95 ms", places=1),
            Column(key="p99_ms", head="p99 ms", places=1),
            Column(key="load_1min", head="load", places=1),
        ),
    ),
}
