"""What stands around the robot, who plays, and a hand that sets the robot down or pushes it."""

import math
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from studio.errors import StudioError
from studio.live.best_runs import MAX_NAME, checked_name
from studio.live.command import Command, Made, Number, OneOf, with_why
from studio.options import SCENES
from studio.scenes.stage import Stage
from studio.sim.pull import MAX_FORCE, MAX_SECONDS

MAX_FAR = 50.0
"""m from the middle of the world."""

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class SetScene(Command):
    """What stands around the robot, and what there is to do; the same again: from its beginning."""

    path: ClassVar[str] = "scene"
    scene: Annotated[str, OneOf("scene", SCENES)]

    def prepare(self, runtime: "Runtime") -> Stage:
        """Build its world. StudioError for a robot that is not in it."""
        if not runtime.puppeteer.link.simulated:
            raise StudioError("scenes are for the simulated robot: serve without --robot")
        return Stage(self.scene, runtime.config.puppeteer.seed)

    def apply(self, runtime: "Runtime", now: float, prepared: Stage) -> Made:
        """The robot stands at its start. StudioError while it is down, or motions are collected."""
        if runtime.mode == "collect":
            raise StudioError("collecting goes on: choose mode live first, then a scene")
        if runtime.safety.needs_reset:
            raise StudioError("the robot is down: reset first, then choose a scene")
        runtime.puppeteer.set_stage(prepared)
        return {}


class SetPerson(Command):
    """Whose runs in scenes are kept from now on; "" keeps none."""

    path: ClassVar[str] = "person"
    name: Annotated[
        str, Field(max_length=MAX_NAME), AfterValidator(lambda name: with_why(checked_name, name))
    ]

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Remember it."""
        runtime.runs.person = self.name
        return {}


class PlaceRobot(Command):
    """Set the simulated robot down at x, y (m in the world, at most 50 from its middle), heading
    yaw (rad; null: as it does). It stands up there from a crouch, as after a reset: only while it
    is stopped, and stays so until armed, or in mode idle."""

    path: ClassVar[str] = "place"
    releases: ClassVar[bool] = True
    x: Number
    y: Number
    yaw: Number | None = Field(default=None, ge=-math.pi, le=math.pi)

    @model_validator(mode="after")
    def _within_reach(self) -> "PlaceRobot":
        if math.hypot(self.x, self.y) > MAX_FAR:
            why = f"a robot is set down at most {MAX_FAR:g} m from the middle of the world"
            raise PydanticCustomError("misfit", "{why}", {"why": why})
        return self

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Set it down. StudioError where it follows somebody, or is no simulated one, or has a
        start of its own; while a take is recorded, which it would tear."""
        puppeteer, recording = runtime.puppeteer, runtime.recorder.recording
        if runtime.mode in ("replay", "collect") or not (
            runtime.safety.stopped or runtime.mode == "idle"
        ):
            raise StudioError(
                "stop the robot, or choose mode idle, before it is set down elsewhere"
            )
        if not puppeteer.link.simulated:
            raise StudioError(f"the robot at {puppeteer.link.name} is no simulated one: carry it")
        if puppeteer.stage.scene.props:
            raise StudioError("a scene has a start of its own: choose the scene free first")
        if recording is not None:
            raise StudioError(f"take {recording} is being recorded: stop it first")
        yaw = puppeteer.robot.yaw if self.yaw is None else self.yaw
        puppeteer.stand_up((np.array([self.x, self.y]), yaw))
        runtime.safety.reset()
        return {}


class Push(Command):
    """A force on the simulated robot's trunk: [x, y, z] N in the world, at most 60 N long, for so
    many seconds, in place of the one before; [0, 0, 0] lets go. A stop lets go, too. It is in no
    take: what the robot did is, so that a replay shows it, and a take driven anew is not pushed."""

    path: ClassVar[str] = "push"
    force: tuple[Number, Number, Number]
    seconds: Number = Field(default=0.3, ge=0.0, le=MAX_SECONDS)

    @model_validator(mode="after")
    def _within_reason(self) -> "Push":
        if math.hypot(*self.force) > MAX_FORCE + 1e-9:  # as much as any direction's is rounded
            why = f"a push has at most {MAX_FORCE:g} N"
            raise PydanticCustomError("misfit", "{why}", {"why": why})
        return self

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Push from the next period on. StudioError where the robot is stopped, or shows a take or
        what is to be acted out."""
        if runtime.safety.stopped:
            raise StudioError(f"{runtime.safety.stop_line}; then push")
        if runtime.mode in ("replay", "collect"):
            raise StudioError(f"mode {runtime.mode} is no time to push: choose mode live first")
        runtime.puppeteer.stage.push(self.force, self.seconds)
        return {}
