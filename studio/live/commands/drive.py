"""Who is watched, and what the robot does with it."""

import math
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal

from pydantic import Field, StrictBool, model_validator

from studio.control.controllers import CONTROLLERS
from studio.control.staleness import missing
from studio.errors import StudioError
from studio.live.command import Command, Made, Number, OneOf, with_why
from studio.live.replay import Replay, open_replay
from studio.live.robot_watch import begins_live
from studio.live.source_reader import OpenedSource, open_follower, open_for
from studio.options import Steps, Travel
from studio.reference.intent import STATES
from studio.retarget.settings import LIMITS, checked_gain

if TYPE_CHECKING:
    from studio.live.runtime import Runtime

Mode = Literal["idle", "live", "replay", "collect"]
MODES: tuple[Mode, ...] = ("idle", "live", "replay", "collect")


class SetMode(Command):
    """idle: the robot rests; live: it follows the source; replay: a take is shown again; collect:
    motions are shown, acted out and recorded. leaving: only out of this mode; in another nothing
    happens, for somebody has chosen it meanwhile."""

    path: ClassVar[str] = "mode"
    mode: Annotated[str, OneOf("mode", MODES)]
    leaving: Annotated[str, OneOf("mode", MODES)] | None = None

    @property
    def prepares(self) -> bool:
        """A take is read to be replayed, and whoever acts for the built-in operator made."""
        return self.mode in ("replay", "collect")

    def prepare(self, runtime: "Runtime") -> Replay | OpenedSource | None:
        """replay: the take watched, or else the last recorded. collect: the person who acts."""
        if self.mode == "collect":
            return open_follower(runtime.config.puppeteer, runtime.source)
        if self.mode == "replay":
            take = runtime.source.take or runtime.last_take
            return open_replay(runtime.config.sessions, take) if take else None
        return None

    def apply(self, runtime: "Runtime", now: float, prepared: Any = None) -> Made:
        """Change the mode; a running take of a plan is thrown away when collecting is left."""
        if self.leaving not in (None, runtime.mode):
            return {}
        if self.mode == "collect":
            runtime.enter_collect(prepared, now)
            return {}
        if self.mode == "replay":
            runtime.replay = prepared or runtime.replay
        runtime.enter(self.mode, now)
        return {}


class SetStateLock(Command):
    """Lock the controller to a state, or let the selector choose (auto)."""

    path: ClassVar[str] = "state"
    state: Annotated[str, OneOf("state", ("auto", *STATES))]

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Lock or free."""
        runtime.puppeteer.lock_state(self.state)
        return {}


class SetSource(Command):
    """Where human motion comes from: operator[:TASK], bvh:FILE, frames:FILE, take:NAME, stream …"""

    path: ClassVar[str] = "source"
    source: str = Field(max_length=1024)

    def prepare(self, runtime: "Runtime") -> OpenedSource:
        """Open and scan it."""
        return open_for(self.source, runtime.config.puppeteer, runtime.config.sessions)

    def apply(self, runtime: "Runtime", now: float, prepared: OpenedSource) -> Made:
        """Watch it; live and armed where it starts so, else idle until armed. StudioError while
        collecting: nobody leaves that unawares."""
        if runtime.mode == "collect":
            then = "choose mode live first, then another source, then collect"
            raise StudioError(f"collecting goes on: {then}")
        runtime.replaced.forget()
        runtime.reader.close()
        runtime.watch(prepared, now)
        live = begins_live(runtime.puppeteer, runtime.source)
        runtime.mode, runtime.idle_by_source = ("live" if live else "idle"), not live
        if not runtime.safety.stopped:
            runtime.safety.armed = live
        return {}


class SetController(Command):
    """Which controller turns the reference into an action."""

    path: ClassVar[str] = "controller"
    controller: Annotated[str, OneOf("controller", CONTROLLERS)]

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Use it from the next period on."""
        runtime.puppeteer.set_controller(self.controller)
        return {}


class SetGain(Command):
    """A slider: tilt_gain (times the trunk's tilt), dead_zone (rad), speed_cap (m/s) or joint_speed
    (rad/s)."""

    path: ClassVar[str] = "gain"
    name: Annotated[str, OneOf("gain", LIMITS)]
    value: Number = Field(
        description="; ".join(f"{k}: {low:g} to {high:g}" for k, (low, high) in LIMITS.items()),
    )

    @model_validator(mode="after")
    def _within_its_own_limits(self) -> "SetGain":
        with_why(checked_gain, self.name, self.value)
        return self

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Set it."""
        runtime.puppeteer.set_gain(self.name, self.value)
        return {}


class SetMirror(Command):
    """Move as in a mirror, or side for side."""

    path: ClassVar[str] = "mirror"
    mirror: StrictBool

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """From the next pose on."""
        runtime.puppeteer.set_mirror(self.mirror)
        return {}


class SetTravel(Command):
    """Walk through space beside a person who does ("auto"), or read marches alone ("off")."""

    path: ClassVar[str] = "travel"
    travel: Travel

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """From the next period on."""
        runtime.puppeteer.set_walk(travel=self.travel)
        return {}


class SetSteps(Command):
    """Walk in the steps that the mapper says ("mapped"), or evenly at its speed ("generated")."""

    path: ClassVar[str] = "steps"
    steps: Steps

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """From the next period on."""
        runtime.puppeteer.set_walk(steps=self.steps)
        return {}


class Calibrate(Command):
    """Measure bone lengths and heading anew from what is seen now."""

    path: ClassVar[str] = "calibrate"

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """The way the person faces now is straight ahead. StudioError where nobody is seen."""
        then = "stand before the sensor, upright and quiet, then calibrate"
        age = runtime.safety.stale_s(now)
        unseen, why = missing(math.inf if age is None else age)
        if unseen:
            raise StudioError(f"{why}; {then}")
        if not runtime.puppeteer.retargeter.extractor.calibrator.neutral_now():
            raise StudioError(f"hips and shoulders are not seen: {then}")
        return {}
