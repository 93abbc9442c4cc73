"""The studio's state as the API answers it: its schema, and so the page's types.

Answers are plain dicts, written out where they are made; nothing here runs when one is given. Each
type names every key that is sent (a test compares them), so that the schema hides none.
"""

from typing import Annotated, Any, Literal, NotRequired

from typing_extensions import TypedDict

from studio.control.controllers import CONTROLLERS
from studio.control.drive_command import Reason
from studio.live.collect_stages import Phase
from studio.live.command import OneOf
from studio.options import STYLES, Travel
from studio.reference.intent import STATES
from studio.reference.library import TASKS
from studio.web.answers_tick import Mode, Pose

Style = Annotated[str, OneOf("style", STYLES)]
Controller = Annotated[str, OneOf("controller", CONTROLLERS)]
TaskName = Annotated[str, OneOf("task", TASKS)]


class Calibration(TypedDict):
    """Of the person: heading, leg, and how long it was measured."""

    heading_deg: float
    leg_length_m: float
    seconds: float


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
    """before: to which A/B returns."""

    name: str
    style: Style
    before: str | None


class Control(TypedDict):
    """Which page drives, and all of them."""

    holder: str | None
    pages: list[str]
    free: bool


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


class Following(TypedDict):
    """Whether the robot walks through space beside the person: asked for, they were found to move
    so, and they do now."""

    mode: Travel
    found: bool
    moving: bool


class State(TypedDict):
    """GET /api/state: what the studio is doing, and why nothing moves if nothing does."""

    mode: Mode
    state: str
    transition_to: str | None
    state_lock: Annotated[str, OneOf("state", ("auto", *STATES))]
    expert: str
    votes: dict[str, float]
    stopped: bool
    armed: bool
    needs_reset: bool
    stops: int
    fallen: bool
    why: str
    reason: Reason
    stale_s: float | None
    source: str
    source_report: SourceReport
    scene: str
    latency_ms: dict[str, float]
    period_error_ms: dict[str, float]
    counters: dict[str, int]
    robot: Pose  # type: ignore[valid-type]
    controller: Controller
    style: Style
    gains: dict[str, float]
    mirror: bool
    travel: Following
    calibration: Calibration
    recording: Recording | None
    recording_error: str | None
    replay: Replay | None
    collect: Collect
    mapper: MapperInUse
    t: float
    control: Control
    tasks: list[TaskName]
    controllers: list[Controller]


class StateMessage(State):
    """The same, as `WS /api/control` sends it to `page` ten times a second."""

    type: Literal["state"]
    page: str


class Judged(State):
    """judged: which take an action kept or rejected."""

    judged: dict[str, Any] | None


class Refused(TypedDict):
    """Any refusal. error: the same as `why`."""

    why: str
    error: str


REFUSED: dict[int, str] = {
    404: "there is none of that name",
    409: "not applied",
    411: "how long the body is was not said",
    413: "too large",
    415: "not a kind of file that is read",
    422: "it does not fit, or cannot be used",
    507: "there is no room to keep it",
}
"""What each status of a refusal means."""


def answers(kind: Any, *refusals: int) -> dict[str, Any]:
    """Options of a route whose answer the schema is to describe as `kind`, without checking it.

    refusals: the statuses, of `REFUSED`, with which it may refuse.
    """
    return {"response_model": None, "responses": {200: {"model": kind}, **refusing(*refusals)}}


def refusing(*statuses: int) -> dict[int | str, dict[str, Any]]:
    """The same for its refusals alone."""
    return {s: {"model": Refused, "description": f"{REFUSED[s]}: see `why`"} for s in statuses}
