"""Takes, what they cover, and what is trained on them, as the API answers it, for its schema."""

from dataclasses import dataclass
from typing import Any, Literal, NotRequired

from typing_extensions import TypedDict

from studio.live.state_parts import Style, TaskName
from studio.reference.intent import StateName
from studio.takes.align.alignment import Alignment
from studio.takes.bin import Binned
from studio.takes.listing import TakeInfo


class Task(TypedDict):
    """What can be collected, and what the person is told."""

    task: TaskName
    state: StateName
    prompt: str


class Axis(TypedDict):
    """edges (n + 1,) in `unit`; counts (n,) frames."""

    name: str
    unit: str
    task: TaskName
    edges: list[float]
    counts: list[int]


class Covered(TypedDict):
    """A state's part of the map. share: of its bins that hold enough."""

    seconds: float
    share: float
    axes: list[Axis]


class Proposal(TypedDict):
    """What to record next."""

    task: TaskName
    why: str


class CoverageMap(TypedDict):
    """enough: frames that fill a bin."""

    enough: int
    states: dict[str, Covered]
    proposals: list[Proposal]


class CollectSession(TypedDict):
    """One operator's takes of one day."""

    name: str
    operator: str
    day: str
    notes: str
    calibration: dict[str, Any] | None
    takes: list[str]


class Started(TypedDict):
    """The take that records now."""

    name: str


class Stopped(Started):
    """The take that ended. ticks: on its tape."""

    ticks: int


class Deleted(Started):
    """The take in the bin."""

    deleted: bool


@dataclass(frozen=True, kw_only=True)
class Aligned(TakeInfo):
    """The take, and how well person and robot agreed; only where an alignment was accepted."""

    before: Alignment | None = None
    after: Alignment | None = None


class Split(TypedDict):
    """What was one take."""

    takes: tuple[TakeInfo, TakeInfo]


class Acted(TypedDict):
    """done: names, in order. refused: {name: why}. binned: places in the bin of those deleted."""

    done: list[str]
    refused: dict[str, str]
    binned: list[str]


class Pictures(TypedDict):
    """pictures: {name: SVG}. refused: {name: why there is none}."""

    pictures: dict[str, str]
    refused: dict[str, str]


class Scores(TypedDict):
    """scores: {name: [0, 1]}. refused: {name: why there is none}."""

    scores: dict[str, float]
    refused: dict[str, str]


class Bin(TypedDict):
    """bytes: what emptying it frees. takes: the last one deleted first."""

    bytes: int
    takes: list[Binned]


class Export(TypedDict):
    """A file being made of many takes. done of total: gone through. left_out: {name: why}.
    file: its name, once it is done; bytes: its size."""

    id: str
    status: Literal["running", "done", "failed", "cancelled"]
    format: str
    done: int
    total: int
    left_out: dict[str, str]
    file: str
    bytes: int
    why: str


class Imported(TypedDict):
    """takes: their names here. refused: {name: why}. rejected: frames left out."""

    takes: list[str]
    refused: dict[str, str]
    rejected: int


class Timeline(TypedDict):
    """Curves over a take of `seconds` s: t (N,) s; human and robot (N, channels) in units of
    what each channel usually shows; contact (N, 4)."""

    t: list[float]
    channels: list[str]
    human: list[list[float | None]]
    robot: list[list[float | None]]
    state: list[str]
    seconds: float
    contact: list[list[float]]


class Series(TypedDict):
    """What was asked of the robot beside what it did: t_s (N,) s into the take, and by name, unit
    included, signals (N,), null where there is none. problem: why the tape ends early, or ""."""

    t_s: list[float]
    signals: dict[str, list[float | None]]
    seconds: float
    ticks: int
    problem: str


class Score(TypedDict):
    """On held-out pairs."""

    joint_rmse_deg: float


class StateScores(TypedDict):
    """A state's training: how much it learnt from, what was held out, and each method's score."""

    event: Literal["scores"]
    state: str
    pairs: int
    held_out_pairs: int
    held_out: str
    takes: list[str]
    steps: int
    seconds: float
    scores: dict[str, Score]


class StateProgress(TypedDict):
    """curve: (step, loss) as learnt so far."""

    curve: list[tuple[int, float]]
    step: NotRequired[int]
    steps: NotRequired[int]
    result: NotRequired[StateScores]


class PairCounts(TypedDict):
    """counts: pairs per state. left_out: {state: why there is too little to train it}."""

    counts: dict[str, int]
    left_out: dict[str, str]


class Training(PairCounts):
    """The last training. seconds: since it began."""

    name: str
    status: Literal["running", "done", "failed", "cancelled"]
    event: str
    seconds: float
    states: dict[str, StateProgress]
    why: str


class DataSet(TypedDict):
    """A data set version; its manifest says more."""

    version: str
    made: str
    takes: list[Any]
    count: int


class TrainedMapper(TypedDict):
    """A mapper trained here; its sidecar says more."""

    name: str
    made: str
    style: Style
    states: list[str]
    takes: list[str]


class Rival(TypedDict):
    """A mapper to compare with. letter: in the paper's comparison, or "". given: what it is fitted
    to. source, limits: as its file says, or ""."""

    name: str
    letter: str
    title: str
    given: str
    source: str
    limits: str
