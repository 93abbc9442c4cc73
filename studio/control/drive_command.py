"""What whoever drives asks of the puppeteer: how to drive, a command each period."""

from dataclasses import dataclass
from enum import Enum
from typing import Literal

from studio.options import Steps, Travel
from studio.reference.stances import JOINT_SPEED


@dataclass(frozen=True, kw_only=True)
class PuppeteerConfig:
    """How to drive.

    style: which human motion means walking. controller: a name of control.controllers, None for
    the default. state: "auto" or the state to stay in. seed, scene: of the world. mirror: as in a
    mirror.
    travel: "auto" walks through space beside a person who does, "off" reads marches alone.
    steps: the gait generator's own, at the speed and turn that a network says, or as it maps them.
    tilt_gain: times the trunk's tilt. dead_zone: rad of tilt ignored. speed_cap: m/s. joint_speed:
    rad/s of a standing or sitting reference's joints.
    """

    style: str = "march"
    controller: str | None = None
    state: str = "auto"
    seed: int = 0
    scene: str = "empty"
    mirror: bool = False
    travel: Travel = "auto"
    steps: Steps = "mapped"
    tilt_gain: float = 1.0
    dead_zone: float = 0.0
    speed_cap: float = 1.0
    joint_speed: float = JOINT_SPEED["stand"]


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
    "hurried",
    "robot",
]
"""Why the robot does not do what the person does, for programs; "": it does. Words are added at the
end; none changes its meaning."""


class Directive(Enum):
    """What safety asks of the state machine."""

    FOLLOW = "follow"
    """Follow the person."""
    REST = "rest"
    """Go to the neutral pose of the present state; from walking, stand: what tracks a walk was not
    trained to keep still, and who is left standing in it falls."""
    KEEP = "keep"
    """Follow without leaving the present state, or rest in it where the person means another; from
    walking, stand."""
    STAND = "stand"
    """Go to neutral standing, out of a transition too."""


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
