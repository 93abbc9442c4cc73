"""Recording takes, and showing them again."""

from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import Field, StrictBool

from studio.errors import StudioError
from studio.live.command import Body, Command, Made, Number
from studio.live.replay import Replay, open_review

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class StartTake(Command):
    """Record from the next tick on. label: to find the take again by. name: chosen if left out."""

    path: ClassVar[str] = "takes/start"
    tag: ClassVar[str] = "takes"
    misfit_status: ClassVar[int] = 422
    label: str = Field(default="", max_length=120)
    name: str | None = Field(default=None, max_length=120)

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Begin the take; without label and name it is called as its source. StudioError for a
        source that has ended, and in a mode that records by itself or shows what was."""
        runtime.reader.refuse_ended("record")
        if runtime.mode == "collect":
            raise StudioError("collecting records its own takes: choose mode live to record one")
        if runtime.mode == "replay":
            raise StudioError("a take is shown, and nothing new to record: choose mode live first")
        label = self.label.strip() or runtime.source.label
        name = runtime.recorder.start(label, name=self.name, about=runtime.about())
        runtime.puppeteer.align_robot_to_reference()
        return {"name": name}

    def answer(self, state: dict[str, Any], made: Made) -> dict[str, Any]:
        """Its name."""
        return made


class StopTake(Command):
    """Close the take being recorded."""

    path: ClassVar[str] = "takes/stop"
    tag: ClassVar[str] = "takes"

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """End it. StudioError if it belongs to a plan, or if nothing is recorded."""
        if runtime.mode == "collect":
            raise StudioError("the take belongs to the plan: abort it, or let it end")
        stopped = runtime.recorder.stop()
        runtime.last_take = stopped["name"]
        return stopped

    def answer(self, state: dict[str, Any], made: Made) -> dict[str, Any]:
        """Its name and ticks."""
        return made


class Seeking(Body):
    """Where to in a take (s), playing on or paused, at a speed (times real time), in a loop."""

    t: Number | None = None
    playing: StrictBool | None = None
    speed: Number | None = Field(default=None, ge=Replay.speeds[0], le=Replay.speeds[1])
    loop: StrictBool | None = None

    def seek(self, replay: Replay) -> None:
        """Move there; what is None stays."""
        replay.seek(self.t, self.playing, self.speed, self.loop)


class Seek(Seeking, Command):
    """Move in the take that is replayed: to `t` s, playing on or paused, at a speed, in a loop."""

    path: ClassVar[str] = "seek"

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Move; refused where nothing is replayed."""
        if runtime.mode != "replay" or runtime.replay is None:
            raise StudioError("nothing is replayed: choose mode replay first")
        self.seek(runtime.replay)
        return {}


class ShowTake(Seeking, Command):
    """Show a take in the 3-D view (mode replay) as its edits leave it. aligned: the person as lag
    and warp put them. The rest as in seeking."""

    path: ClassVar[str] = "takes/{name}/show"
    tag: ClassVar[str] = "review"
    misfit_status: ClassVar[int] = 422
    name: str
    aligned: StrictBool = True

    def prepare(self, runtime: "Runtime") -> Replay:
        """Read its table, which takes seconds for a take of an hour."""
        replay = open_review(runtime.config.sessions, self.name, aligned=self.aligned)
        self.seek(replay)
        return replay

    def apply(self, runtime: "Runtime", now: float, prepared: Replay) -> Made:
        """Replay it."""
        runtime.replay = prepared
        runtime.enter("replay", now)
        return {}
