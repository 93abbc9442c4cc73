"""Robot motions to be acted out: a task, drawn and realised, between two rests, with its beats."""

from collections.abc import Sequence
from dataclasses import asdict, dataclass, fields, replace
from typing import Annotated, Any

import numpy as np
from numpy.typing import NDArray
from pydantic import ConfigDict, Field, StrictInt, TypeAdapter, ValidationError, model_validator

from studio import geometry
from studio.errors import StudioError
from studio.live.command import Number, OneOf, misfit, with_known_keys
from studio.reference.intent import Intent, IntentTrack, StateName
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.reference.rest_padding import beats, between_rests
from studio.reference.stances import NEUTRAL
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

QUIET_S = 1.5
"""s of rest at both ends of what is shown: longer than anybody is late."""
MIN_SECONDS, MAX_SECONDS, MAX_TAKES = 2.0, 60.0, 100
PROMPTS: dict[str, str] = {
    "quiet": "Stand upright and quiet",
    "tilt": "Lean, bend and twist your trunk as the robot does",
    "crouch": "Bend your knees as the robot lowers itself",
    "manipulate_right": "Reach with your right arm as its right paw goes up",
    "manipulate_left": "Reach with your left arm as its left paw goes up",
    "tilt_manipulate": "Reach with an arm and lean as the robot does",
    "walk": "March in place, a step of yours for each tick",
    "turn": "March in place, a step for each tick, and turn your trunk where it turns",
    "march": "March in place with it, and pause when it pauses",
    "sit_quiet": "Squat or sit, and keep quiet",
    "sit_tilt": "Sit, and lean as the robot does",
    "sit_manipulate": "Sit, and reach with your arms as its paws go up",
}
"""What to tell the person, by task."""


@dataclass(frozen=True, kw_only=True)
class PlanItem:
    """A task to act out `takes` times. seconds: of motion, rests not counted. difficulty in [0, 1]:
    the share of the robot's range that is asked for (`Task.sample`)."""

    __pydantic_config__ = ConfigDict(extra="forbid")
    task: Annotated[str, OneOf("task", TASKS)]
    takes: Annotated[StrictInt, Field(ge=1, le=MAX_TAKES)] = 3
    seconds: Annotated[Number, Field(ge=MIN_SECONDS, le=MAX_SECONDS)] = 8.0
    difficulty: Annotated[Number, Field(ge=0.0, le=1.0)] = 0.7

    @model_validator(mode="before")
    @classmethod
    def _known_keys(cls, asked: Any) -> Any:
        return with_known_keys(asked, [field.name for field in fields(cls)])

    def checked(self) -> "PlanItem":
        """Itself; StudioError for what cannot be done."""
        try:
            return _ITEM.validate_python(asdict(self))
        except ValidationError as error:
            raise StudioError(misfit(error.errors())) from error


_ITEM = TypeAdapter(PlanItem)


@dataclass(frozen=True, kw_only=True)
class ShownMotion:
    """One motion as it is shown. poses: one a control period, from x = y = 0 and heading 0.

    track: what is meant, frame by frame. beats: s at which a foot lifts (gaits only).
    """

    task: str
    state: StateName
    track: IntentTrack
    poses: Sequence[ReferencePose]
    beats: tuple[float, ...]

    def __len__(self) -> int:
        return len(self.poses)

    @property
    def seconds(self) -> float:
        """Duration with both rests."""
        return len(self.poses) * CONTROL_DT

    @property
    def prompt(self) -> str:
        """What to tell the person."""
        return PROMPTS.get(self.task, "Act out what the robot does")

    def intent(self, frame: int) -> Intent:
        """What is meant at a frame; before and after it, what is meant at the ends."""
        return self.track[min(max(frame, 0), len(self) - 1)]


def draw_motion(item: PlanItem, seed: Sequence[int]) -> ShownMotion:
    """The motion of an item's task that follows from `seed`: some 0.2 s of work."""
    task = TASKS[item.checked().task]
    track = task.sample(np.random.default_rng(list(seed)), item.seconds, item.difficulty)
    track = between_rests(track, QUIET_S)
    return ShownMotion(
        task=item.task,
        state=task.state,
        track=track,
        poses=realize(track).poses(),
        beats=tuple(round(float(t), 3) for t in beats(track)),
    )


class Place:
    """Where in the world shown motions are: each goes on from where the last one ended."""

    def __init__(self) -> None:
        self.xy, self.yaw = np.zeros(2), 0.0

    def stand_at(self, pose: RobotPose, yaw: float) -> None:
        """The neutral pose of what is shown next lies at `pose`, facing `yaw` rad."""
        self.xy, self.yaw = np.asarray(pose.base_pos[:2], dtype=np.float64).copy(), yaw

    def of(self, pose: ReferencePose) -> ReferencePose:
        """A pose shown from the origin, here."""
        turn = geometry.quat_from_yaw(self.yaw)
        shift = np.array([self.xy[0], self.xy[1], 0.0])
        return replace(
            pose,
            base_pos=geometry.quat_rotate(turn, pose.base_pos) + shift,
            base_quat=geometry.quat_mul(turn, pose.base_quat),
            base_lin_vel_w=geometry.quat_rotate(turn, pose.base_lin_vel_w),
        )


def at_rest(state: StateName) -> ReferencePose:
    """The neutral pose of a state, not moving."""
    neutral = NEUTRAL[state]
    return ReferencePose(
        base_pos=neutral.base_pos,
        base_quat=neutral.base_quat,
        joint_pos=neutral.joint_pos,
        foot_contact=neutral.foot_contact,
    )
