"""What stands around the robot, who plays, and a hand that pushes the robot."""

import math
from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import AfterValidator, Field, model_validator
from pydantic_core import PydanticCustomError

from studio.errors import StudioError
from studio.live.best_runs import MAX_NAME, checked_name
from studio.live.command import Command, Made, Number, OneOf, with_why
from studio.options import SCENES
from studio.scenes.stage import Stage
from studio.sim.pull import MAX_FORCE, MAX_SECONDS

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class SetScene(Command):
    """What stands around the robot, and what there is to do; the same again: from its beginning."""

    path: ClassVar[str] = "scene"
    scene: Annotated[str, OneOf("scene", SCENES)]

    def prepare(self, runtime: "Runtime") -> Stage:
        """Build its world. StudioError for one that is not for this robot."""
        link = runtime.puppeteer.link
        seed = runtime.config.puppeteer.seed
        return Stage(self.scene, seed, None if link.simulated else link)

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


class Push(Command):
    """A force on the simulated robot's trunk: [x, y, z] N in the world, at most 60 N long, for so
    many seconds, in place of the one before; [0, 0, 0] lets go. A stop lets go, too. It is in no
    take: what the robot did is, so that a replay shows it, and a take driven anew is not pushed."""

    path: ClassVar[str] = "push"
    force: tuple[Number, Number, Number]
    seconds: Number = Field(default=0.3, ge=0.0, le=MAX_SECONDS)

    @model_validator(mode="after")
    def _within_reason(self) -> "Push":
        if math.hypot(*self.force) > MAX_FORCE:
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
