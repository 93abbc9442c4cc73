"""Recording takes, and showing them again."""

import re
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from pydantic import BaseModel, Field

from studio.errors import StudioError
from studio.live.command import Command, Made
from studio.live.replay import SPEEDS, Replay, open_review

if TYPE_CHECKING:
    from studio.live.runtime import Runtime

_HASHED = re.compile(r"^[0-9a-f]{8}_")


def in_words(spec: str) -> str:
    """Source and motion of a spec: bvh:/tmp/1a2b3c4d_march.bvh is "bvh march", the operator's tour
    "operator tour", driving by keys "keyboard"."""
    kind, _, motion = spec.partition(":")
    if spec == "operator:interactive":
        return "keyboard"
    if kind in ("bvh", "frames"):
        motion = _HASHED.sub("", Path(motion).stem)
    elif spec == "operator":
        motion = "tour"
    return f"{kind} {motion}".replace("_", " ").strip()


class StartTake(Command):
    """Record from the next tick on. label: to find the take again by. name: chosen if left out."""

    path: ClassVar[str] = "takes/start"
    tag: ClassVar[str] = "takes"
    misfit_status: ClassVar[int] = 422
    label: str = Field(default="", max_length=120)
    name: str | None = Field(default=None, max_length=120)

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Begin the take; without label and name it is called as its source. StudioError for a
        source that has ended."""
        runtime.reading.refuse_ended("record")
        label = self.label.strip() or in_words(runtime.source.name)
        name = runtime.recorder.start(label, name=self.name, about=runtime.about())
        runtime.puppeteer.meet()
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


class Seeking(BaseModel):
    """Where to in a take (s), playing on or paused, at a speed (times real time), in a loop."""

    t: float | None = Field(default=None, allow_inf_nan=False)
    playing: bool | None = None
    speed: float | None = Field(default=None, allow_inf_nan=False, ge=SPEEDS[0], le=SPEEDS[1])
    loop: bool | None = None

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


class ShowTake(Seeking, Command, extra="forbid"):
    """Show a take in the 3-D view (mode replay) as its edits leave it. aligned: the person as lag
    and warp put them. The rest as in seeking."""

    path: ClassVar[str] = "takes/{name}/show"
    tag: ClassVar[str] = "review"
    misfit_status: ClassVar[int] = 422
    name: str
    aligned: bool = True

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
