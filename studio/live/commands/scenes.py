"""What stands around the robot, and who plays."""

from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import AfterValidator, Field

from studio.errors import StudioError
from studio.live.best_runs import MAX_NAME, checked_name
from studio.live.command import Command, Made, OneOf, with_why
from studio.options import SCENES
from studio.scenes.stage import Stage

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class SetScene(Command):
    """What stands around the robot, and what there is to do; the same again: from its beginning."""

    path: ClassVar[str] = "scene"
    scene: Annotated[str, OneOf("scene", SCENES)]

    def prepare(self, runtime: "Runtime") -> Stage:
        """Build its world."""
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
