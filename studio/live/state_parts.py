"""The objects within the state (`live.state`), as whoever makes one and the schema know them."""

from typing import Annotated, NotRequired

from typing_extensions import TypedDict

from studio.control.controllers import CONTROLLERS
from studio.link.link import Level
from studio.live.collect_stages import Phase
from studio.live.command import OneOf
from studio.options import STYLES, Travel
from studio.reference.intent import StateName
from studio.reference.library import TASKS

Style = Annotated[str, OneOf("style", STYLES)]
Controller = Annotated[str, OneOf("controller", CONTROLLERS)]
TaskName = Annotated[str, OneOf("task", TASKS)]


class Calibration(TypedDict):
    """Of the person: heading, leg, and how long it was measured."""

    heading_deg: float
    leg_length_m: float
    seconds: float


class Arrivals(TypedDict):
    """How live frames come of late: see `studio.mocap.arrivals`."""

    rate_hz: float
    jitter_ms: float
    late_ms: dict[str, float]
    wait_ms: dict[str, float]


class Recording(TypedDict):
    """The take being written."""

    name: str
    ticks: int


class Replay(TypedDict):
    """The take being shown. aligned: None for a source that knows no alignment."""

    name: str
    t: float
    seconds: float
    playing: bool
    speed: float
    loop: bool
    aligned: bool | None


class Played(TypedDict):
    """What has a timeline, and where in it we are. playing: it goes on now."""

    position_s: float
    length_s: float
    playing: bool
    loop: bool
    speed: float
    ended: bool


class PlanRow(TypedDict):
    """A run of the same motion in a plan."""

    task: TaskName
    seconds: float
    takes: int
    kept: int
    skipped: int


class Collect(TypedDict("_Try", {"try": int}, total=False)):
    """Where collecting stands; what follows `plan` is there while a motion is up."""

    phase: Phase
    t: float
    remaining: float | None
    operator: str
    notes: str
    hands_free: bool
    actions: list[str]
    done: int
    total: int
    take: str | None
    kept: list[str]
    rejected: list[str]
    why: str
    plan: list[PlanRow]
    task: NotRequired[TaskName]
    state: NotRequired[str]
    number: NotRequired[int]
    takes: NotRequired[int]
    prompt: NotRequired[str]
    seconds: NotRequired[float]
    quiet_s: NotRequired[float]
    beats: NotRequired[list[float]]


class MapperInUse(TypedDict):
    """before: to which A/B returns. refused: the states that it does not map, where the shipped
    experts do, and why. fitting: the rival that is being fitted to be the next."""

    name: str
    style: Style
    before: str | None
    refused: dict[StateName, str]
    fitting: str | None


class RefusedFrames(TypedDict):
    """Frames of a source that were not used, and the first reasons why."""

    frames: int
    why: list[str]


class SourceReport(TypedDict):
    """What was found in a source. joints_found: ours to the file's; scale_m: m a unit of its."""

    joints_found: dict[str, list[str]]
    joints_missing: list[str]
    scale_m: float | None
    up_axis: str | None
    refused: RefusedFrames
    notes: list[str]


class RobotBehind(TypedDict):
    """The robot behind a link (docs/robot-link.md): what is sent to it, its phase and why it is
    limp, s since it was heard, silent from so many on, datagrams that were not believed."""

    name: str
    level: Level
    phase: str
    why: str
    heard_s: float
    silent: bool
    refused: int


class Following(TypedDict):
    """Whether the robot walks through space beside the person: asked for, they were found to move
    so, and they do now."""

    mode: Travel
    found: bool
    moving: bool
