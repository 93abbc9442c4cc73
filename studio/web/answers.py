"""The studio's state and its ticks as the API answers them: its schema, and so the page's types.

Answers are plain dicts, written out where they are made; nothing here runs when one is given. Each
type names every key that is sent (a test compares them), so that the schema hides none.
"""

from typing import Annotated, Any, Literal, NotRequired

from typing_extensions import TypedDict

from studio.control.drive_command import Reason
from studio.control.trackers import CONTROLLERS
from studio.live.collect_stages import Phase
from studio.live.command import OneOf
from studio.live.commands import MODES
from studio.options import Travel
from studio.reference.intent import STATES
from studio.reference.library import TASKS
from studio.retarget.store import STYLES

Mode = Annotated[str, OneOf("mode", MODES)]
Style = Annotated[str, OneOf("style", STYLES)]
Controller = Annotated[str, OneOf("controller", CONTROLLERS)]
TaskName = Annotated[str, OneOf("task", TASKS)]


class Pose(TypedDict):
    """A robot: base_pos (3,) m, base_quat (4,) wxyz, joint_pos (12,) rad, foot_contact (4,)."""

    base_pos: list[float]
    base_quat: list[float]
    joint_pos: list[float]
    foot_contact: list[float]


class MovingPose(Pose):
    """Also base_lin_vel_w (3,) m/s."""

    base_lin_vel_w: list[float]


class SimulatedPose(MovingPose):
    """Also foot_pos_w (4, 3) m, and whether the trunk touches the floor."""

    foot_pos_w: list[list[float]]
    trunk_contact: bool


class Human(TypedDict):
    """A human frame: positions (19, 3) m and confidence (19,) of the skeleton `studio`."""

    t: float
    skeleton: str
    positions: list[list[float]]
    confidence: list[float]


class TickMessage(TypedDict):
    """One control period, as `WS /api/ticks` sends it. target: (12,) rad."""

    index: int
    t: float
    mode: Mode
    state: str
    transition_to: str | None
    expert: str
    votes: dict[str, float]
    controller: str
    human: Human | None
    human_fresh: bool
    reference: MovingPose
    robot: SimulatedPose
    target: list[float]
    clipped: bool
    fallen: bool
    why: str
    timings_ms: dict[str, float]
    counters: dict[str, int]


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
    robot: Pose
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


def answers(kind: Any) -> dict[str, Any]:
    """Options of a route whose answer the schema is to describe as `kind`, without checking it."""
    return {"response_model": None, "responses": {200: {"model": kind}}}
