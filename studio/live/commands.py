"""Frozen commands: everything another thread may ask of the control loop, and its answer."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, Literal

if TYPE_CHECKING:
    from studio.live.collect import CollectPlan
    from studio.live.shown import PlanItem

Mode = Literal["idle", "live", "replay", "collect"]
MODES: tuple[Mode, ...] = ("idle", "live", "replay", "collect")
StateLock = Literal["auto", "stand", "walk", "sit"]
STATE_LOCKS: tuple[StateLock, ...] = ("auto", "stand", "walk", "sit")


@dataclass(frozen=True, kw_only=True)
class SetMode:
    """idle: the robot rests; live: it follows the source; replay: a take is shown again; collect:
    motions are shown, acted out and recorded."""

    mode: str


@dataclass(frozen=True, kw_only=True)
class SetStateLock:
    """auto: the selector decides; a state's name: the controller stays there."""

    state: str


@dataclass(frozen=True, kw_only=True)
class SetSource:
    """Replace the source of human motion by `spec` (contract.md, sources)."""

    spec: str


@dataclass(frozen=True, kw_only=True)
class Stop:
    """Latching emergency stop: damping until a reset. Changes neither mode nor lock."""

    by: str = "operator"


@dataclass(frozen=True, kw_only=True)
class Reset:
    """Stand up again (at most 3 s); a latched stop stays latched until `Arm`."""


@dataclass(frozen=True, kw_only=True)
class Arm:
    """Release the latched stop and let the robot follow, with a ramp of 1 s."""


@dataclass(frozen=True, kw_only=True)
class Disarm:
    """Stop following without damping: the robot goes to a neutral stance."""


@dataclass(frozen=True, kw_only=True)
class StartTake:
    """Record from the next tick on; `name` None lets the recorder choose one."""

    label: str = ""
    name: str | None = None


@dataclass(frozen=True, kw_only=True)
class StopTake:
    """Close the take being recorded."""


@dataclass(frozen=True, kw_only=True)
class SetGain:
    """Change one of the operator's sliders; `name` is a field of puppeteer.Gains."""

    name: str
    value: float


@dataclass(frozen=True, kw_only=True)
class SetController:
    """Which controller turns the reference into an action: a name of imitation.controllers."""

    name: str


@dataclass(frozen=True, kw_only=True)
class SetMirror:
    """Mirror the person, as a mirror does, or not."""

    mirror: bool


@dataclass(frozen=True, kw_only=True)
class Calibrate:
    """Take bone lengths and heading anew from what is seen from now on."""


@dataclass(frozen=True, kw_only=True)
class TakeControl:
    """The page `page` holds control: from now on its heartbeats must not stop."""

    page: str


@dataclass(frozen=True, kw_only=True)
class ReleaseControl:
    """The page `page` gives control up, in good order."""

    page: str


@dataclass(frozen=True, kw_only=True)
class Seek:
    """Replay: go to `t` seconds of the take, playing on or paused, at a speed, in a loop."""

    t: float | None = None
    playing: bool | None = None
    speed: float | None = None
    loop: bool | None = None


@dataclass(frozen=True, kw_only=True)
class ShowTake:
    """Replay take `name` as its edits leave it; aligned: the person as lag and warp put them."""

    name: str
    aligned: bool = True
    t: float | None = None
    playing: bool | None = None
    speed: float | None = None
    loop: bool | None = None


@dataclass(frozen=True, kw_only=True)
class SetPlan:
    """What mode collect shows and records."""

    plan: "CollectPlan"


@dataclass(frozen=True, kw_only=True)
class AddToPlan:
    """More to collect, after what is planned."""

    items: "tuple[PlanItem, ...]"


@dataclass(frozen=True, kw_only=True)
class CollectAction:
    """go, skip, keep, redo, next or abort (collect.ACTIONS)."""

    action: str


@dataclass(frozen=True, kw_only=True)
class SetMapper:
    """Map the person by the experts of sessions/mappers/NAME from the next period on; None: by
    those that are shipped. back: by whichever was in use before instead (A/B)."""

    name: str | None = None
    back: bool = False


@dataclass(frozen=True, kw_only=True)
class SetStyle:
    """Walking means another human motion from the next period on: a name of retarget.store.STYLES.
    The shipped experts of that style take over; the built-in operator walks in it too."""

    style: str


RELEASES = (Reset, Arm)
"""What lets a stopped robot move again."""

Command = (
    SetMode
    | SetStateLock
    | SetSource
    | Stop
    | Reset
    | Arm
    | Disarm
    | StartTake
    | StopTake
    | SetGain
    | SetController
    | SetMirror
    | Calibrate
    | TakeControl
    | ReleaseControl
    | Seek
    | ShowTake
    | SetPlan
    | AddToPlan
    | CollectAction
    | SetMapper
    | SetStyle
)


@dataclass(frozen=True, kw_only=True)
class Result:
    """The loop's answer, given after the tick in which a command was applied.

    ok: applied. why: one line, if it was refused. state: the object of GET /api/state after that
    tick. data: what the command made (a take's name and ticks).
    """

    ok: bool
    why: str = ""
    state: dict[str, Any] = field(default_factory=dict)
    data: dict[str, Any] = field(default_factory=dict)
