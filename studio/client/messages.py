"""What docs/contract.md promises of each message; more keys may come with it."""

from collections.abc import Sequence
from typing import Any, Literal, NotRequired, TypedDict

Mode = Literal["idle", "live", "replay", "collect"]
StateLock = Literal["auto", "stand", "walk", "sit"]
TransportAction = Literal["play", "pause", "again", "seek", "step", "speed", "loop"]
Format = Literal["jsonl", "bvh", "npz", "csv", "pairs", "hdf5", "mcap", "lerobot", "html", "takes"]
Skeleton = Literal["studio", "mediapipe", "k4abt", "kinect2"]
Point = Sequence[float] | None
"""[x, y, z] m in the axes of the frame's skeleton; None: that joint is not seen."""


class Frame(TypedDict):
    """A human frame: t s, positions (joints, 3) m in the axes and joint order of `skeleton`,
    confidence (joints,) as that sensor gives it, 0 not seen."""

    t: float
    skeleton: str
    positions: Sequence[Point]
    confidence: NotRequired[Sequence[float]]


class Pose(TypedDict):
    """A robot: base_pos (3,) m, base_quat (4,) wxyz, joint_pos (12,) rad, foot_contact (4,)."""

    base_pos: list[float]
    base_quat: list[float]
    joint_pos: list[float]
    foot_contact: list[float]


class SimulatedPose(Pose):
    """Also foot_pos_w (4, 3) m."""

    foot_pos_w: list[list[float]]


class Tick(TypedDict):
    """One control period (1/30 s). human: a frame of the skeleton `studio`; target: (12,) rad."""

    index: int
    t: float
    mode: Mode
    state: str
    expert: str
    votes: dict[str, float]
    human: Frame | None
    human_fresh: bool
    reference: Pose
    robot: SimulatedPose
    target: list[float]
    clipped: bool
    fallen: bool
    why: str
    counters: dict[str, int]


class Transport(TypedDict):
    """Where in a clip or a take we are. playing: it goes on now."""

    position_s: float
    length_s: float
    playing: bool
    loop: bool
    speed: float
    ended: bool


class State(TypedDict):
    """What the studio is doing, and in `why` why nothing moves if nothing does."""

    mode: Mode
    state: str
    state_lock: StateLock
    expert: str
    votes: dict[str, float]
    stopped: bool
    armed: bool
    needs_reset: bool
    stale_s: float | None
    why: str
    reason: str
    source: str
    source_report: dict[str, Any]
    arrivals: dict[str, Any] | None
    scene: str
    progress: dict[str, Any]
    props: dict[str, list[float]]
    person: str
    push: list[float]
    latency_ms: dict[str, float]
    counters: dict[str, int]
    robot: Pose
    transport: Transport | None


class Take(TypedDict):
    """A recorded take. kept: True, False, or None where nobody has said. trim: (from, to) s."""

    name: str
    label: str
    seconds: float
    ticks: int
    score: float | None
    kept: bool | None
    trim: list[float] | None
    lag: float | None


class StoppedTake(TypedDict):
    """The take that ended, and the ticks on its tape."""

    name: str
    ticks: int
