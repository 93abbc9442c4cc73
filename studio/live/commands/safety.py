"""Stopping, releasing, and which page is watched."""

from typing import TYPE_CHECKING, ClassVar

from studio.errors import StudioError
from studio.live.command import Command, Made

if TYPE_CHECKING:
    from studio.live.runtime import Runtime


class Stop(Command):
    """Emergency stop: damping until a reset; latched until armed. Changes neither mode nor lock.
    Anybody may."""

    path: ClassVar[str] = "stop"
    sender: ClassVar[str] = "by"
    by: str = "operator"

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Latch; a take of a plan that is being recorded is thrown away, a replay paused."""
        runtime.safety.stop(f"emergency stop by {self.by}")
        runtime.collector.abort("stopped: the take was thrown away")
        if runtime.replay is not None:
            runtime.replay.playing = False
        return {"stop": runtime.safety.stops}


class Reset(Command):
    """Stand up again (at most 3 s); a latched stop stays latched until armed."""

    path: ClassVar[str] = "reset"
    releases: ClassVar[bool] = True

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """The robot stands up from a crouch where it is."""
        runtime.puppeteer.stand_up()
        runtime.safety.reset()
        return {}


class Arm(Command):
    """Release the latched stop and follow the person, with a ramp of 1 s."""

    path: ClassVar[str] = "arm"
    releases: ClassVar[bool] = True

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Refused while the robot is down; goes live where only the source had made it idle."""
        why = runtime.safety.arm(now)
        if why:
            raise StudioError(why)
        if runtime.mode == "idle" and runtime.idle_by_source:
            runtime.mode, runtime.idle_by_source = "live", False
        runtime.puppeteer.align_robot_to_reference()
        runtime.puppeteer.rejoin()
        return {}


class Disarm(Command):
    """Stop following without damping: the robot goes to a neutral stance."""

    path: ClassVar[str] = "disarm"

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Rest until armed."""
        runtime.safety.disarm()
        return {}


class TakeControl(Command):
    """The page `page` holds control: from now on its heartbeats must not stop."""

    page: str

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Watch the page's heartbeats."""
        runtime.safety.take_control(self.page, now)
        return {}


class ReleaseControl(Command):
    """The page `page` gives control up, in good order."""

    page: str

    def apply(self, runtime: "Runtime", now: float, prepared: None = None) -> Made:
        """Watch nobody."""
        runtime.safety.release_control(self.page)
        return {}
