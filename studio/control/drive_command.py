"""What whoever drives asks of the puppeteer: how to drive, the sliders, a command each period."""

from dataclasses import dataclass
from typing import Literal, get_args

from studio.control.controller import Directive
from studio.errors import StudioError, unknown_name
from studio.options import Travel


@dataclass(frozen=True, kw_only=True)
class PuppeteerConfig:
    """How to drive.

    style: which human motion means walking. controller: a name of imitation.controllers, None for
    the default. state: "auto" or the state to stay in. seed: of the world. mirror: as in a mirror.
    travel: "auto" walks through space beside a person who does, "off" reads marches alone.
    tilt_gain: times the trunk's tilt. dead_zone: rad of tilt ignored. speed_cap: m/s.
    """

    style: str = "march"
    controller: str | None = None
    state: str = "auto"
    seed: int = 0
    mirror: bool = False
    travel: Travel = "auto"
    tilt_gain: float = 1.0
    dead_zone: float = 0.0
    speed_cap: float = 1.0


Reason = Literal[
    "",
    "idle",
    "unarmed",
    "stopped",
    "fallen",
    "fault",
    "page_lost",
    "source_ended",
    "stale",
    "nobody",
    "overrun",
    "unknown",
    "locked",
    "paused",
]
"""Why the robot does not do what the person does, for programs; "": it does. Words are added at the
end; none changes its meaning."""
REASONS: tuple[Reason, ...] = get_args(Reason)


@dataclass(frozen=True, kw_only=True)
class DriveCommand:
    """What whoever keeps watch asks for in this period: see `control.staleness`, `live.safety`.

    directive: to the controller. damping: motors without stiffness. ramp: s over which following
    eases in, None for the controller's own. mode, why: shown in the tick. reason: the word for the
    line `why`; either both are empty or neither.
    """

    directive: Directive = Directive.FOLLOW
    damping: bool = False
    ramp: float | None = None
    mode: str = "live"
    reason: Reason = ""
    why: str = ""


FOLLOW = DriveCommand()
LIMITS: dict[str, tuple[float, float]] = {
    "tilt_gain": (0.0, 2.0),
    "dead_zone": (0.0, 0.5),
    "speed_cap": (0.0, 1.5),
}
"""Ranges of the operator's sliders: a factor of the tilt, rad of tilt, m/s."""


def checked_gain(name: str, value: float) -> float:
    """The value, if it is within the range of a name of LIMITS, and in its unit.

    Raises StudioError otherwise.
    """
    if name not in LIMITS:
        raise unknown_name("gain", name, LIMITS)
    low, high = LIMITS[name]
    if not low <= value <= high:
        raise StudioError(f"{name} must be between {low} and {high}, not {value}")
    return float(value)
