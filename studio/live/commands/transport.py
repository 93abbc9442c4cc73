"""Moving in what is played: the clip or take that drives the robot, or the take shown again."""

from typing import TYPE_CHECKING, Annotated, ClassVar

from pydantic import Field, StrictBool, StrictInt, model_validator
from pydantic_core import PydanticCustomError

from studio.errors import StudioError
from studio.live.command import Command, Made, Number, OneOf
from studio.live.replay import Replay
from studio.live.state_parts import Played
from studio.live.timeline import Timeline
from studio.robot.a1 import CONTROL_DT

if TYPE_CHECKING:
    from studio.live.runtime import Runtime

_SAYS = {
    "play": None, "pause": None, "again": None, "seek": "position_s", "step": "frames",
    "speed": "speed", "loop": "on",
}  # fmt: skip
"""Each action, and the field that it needs."""


class Transport(Command):
    """Play (from the start, once it has ended), pause, seek, step by frames of 1/30 s, loop, set a
    speed or play again. Refused where the source has no timeline; while a take is recorded, all
    that would tear it (only play and loop are left); play, while the robot is stopped."""

    path: ClassVar[str] = "transport"
    action: Annotated[str, OneOf("action", _SAYS)]
    position_s: Number | None = None
    frames: StrictInt | None = Field(default=None, ge=-1000, le=1000)
    on: StrictBool | None = None
    speed: Number | None = Field(default=None, ge=Timeline.speeds[0], le=Timeline.speeds[1])

    @model_validator(mode="after")
    def _says_what_it_needs(self) -> "Transport":
        said = {n for n in ("position_s", "frames", "on", "speed") if getattr(self, n) is not None}
        needed = _SAYS[self.action]
        if said != ({needed} - {None}):
            why = f"{self.action} needs {needed or 'nothing more'}"
            raise PydanticCustomError("misfit", "{why}", {"why": why})
        return self

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Do it; StudioError says why not."""
        played = playing(runtime)
        if played is None:
            raise StudioError(f"{runtime.source.name} has no timeline: choose a clip or a take")
        if isinstance(played, Timeline):
            self._refuse(runtime)
        if self.action in ("play", "pause"):
            played.seek(playing=self.action == "play")
        elif self.action == "step":
            assert self.frames is not None
            played.seek(played.place + self.frames * CONTROL_DT, playing=False)
        elif self.action == "again":
            played.seek(played.start, playing=True)
        else:
            played.seek(self.position_s, speed=self.speed, loop=self.on)
        return {}

    def _refuse(self, runtime: "Runtime") -> None:
        take = runtime.recorder.recording
        if take is not None and self.action not in ("play", "loop"):
            raise StudioError(f"take {take} is being recorded: stop it first, then {self.action}")
        if runtime.safety.stopped and self.action in ("play", "again"):
            raise StudioError(f"{runtime.safety.stop_line}; then play")


def playing(runtime: "Runtime") -> Timeline | Replay | None:
    """What the transport moves: the take that is shown again, else the source's timeline."""
    if runtime.mode == "replay" and runtime.replay is not None:
        return runtime.replay
    return runtime.reader.timeline


def as_dict(runtime: "Runtime") -> Played | None:
    """`transport` of GET /api/state; None where nothing has a timeline."""
    played = playing(runtime)
    if played is None:
        return None
    return Played(
        position_s=round(played.place, 3),
        length_s=round(played.length, 3),
        playing=played.runs,
        loop=played.loop,
        speed=played.speed,
        ended=played.ended,
    )
