"""Everything that may keep the robot from following the person, in one place: when, and how.

    no human pose                    as `control.staleness` says: hold, then stand
    page in control silent  400 ms   stand (begun within 0.5 s of its loss)
    more than 24 of 30 periods late  stand, until as many are in time: too slow a computer
    emergency stop, fall, fault      damping, latched: reset (stand up), then arm (1 s ramp)
    fall of the page's own demo      damping; 3 s later it stands up and goes on, unless stopped

It decides from times and flags that it is told, never from a clock of its own.
"""

import math
from collections import deque

from studio.control.drive_command import Directive, DriveCommand, Reason
from studio.control.staleness import EPS, missing

PAGE_LOST_AFTER = 0.4
ARM_RAMP = 1.0
DEMO_LIES = 3.0
"""s."""
OVERRUN_WINDOW, OVERRUN_SHARE = 30, 0.8
"""More of the last 30 periods late means that this computer cannot keep the rate, and more in time
that it can again: a robot that walks and stops by turns falls sooner or later."""
Decision = tuple[Directive, Reason, str]


class Safety:
    """Remembers the latches: stopped, armed, who holds control. Only the loop's thread calls it,
    but for `beat`, which any thread may."""

    def __init__(self, *, armed: bool = False) -> None:
        self.stops = 0  # so far: presses, faults, and falls of what was not stopped
        self.stopped = False
        self.needs_reset = False
        self.armed = armed
        self.reason: Reason = ""  # of the stop: stopped, fallen or fault
        self.why = ""
        self.seen_at: float | None = None  # when the last human pose came
        self.falls = 0
        self._rises_at: float | None = None
        self._armed_at: float | None = None
        self._holder: str | None = None
        self._left: str | None = None
        self._beat_at = 0.0
        self._late: deque[bool] = deque(maxlen=OVERRUN_WINDOW)
        self.overrun = False  # most of the last second's periods were late, and not yet in time

    # Latches ------------------------------------------------------------------------------------

    def stop(self, why: str, reason: Reason = "stopped") -> None:
        """Damping, latched until reset and arm."""
        # A damped robot that tips over is no news to whoever has sent a reset.
        self.stops += reason != "fallen" or not self.needs_reset
        self.stopped, self.needs_reset, self.armed = True, True, False
        self.why, self.reason = why, reason
        self._rises_at = None

    def fall(self, now: float, *, demo: bool) -> None:
        """The robot fell: as a stop. demo: nobody drives it, it may stand up by itself."""
        again = not self.stopped
        self.falls += 1
        self.stop("the robot fell", "fallen")
        if demo and again:
            self._rises_at = now + DEMO_LIES

    def rises(self, now: float, *, demo: bool) -> bool:
        """It is time for a fallen demo to stand up; no longer, once somebody else drives."""
        if not demo:
            self._rises_at = None
        return self._rises_at is not None and now >= self._rises_at - EPS

    def reset(self) -> None:
        """The robot stands up; a latched stop stays."""
        self.needs_reset, self._rises_at = False, None

    def arm(self, now: float) -> str:
        """Release the latch; the robot follows again over a ramp. Why not, or "".

        Whoever arms takes the place of a page that has gone silent: it is watched again from its
        next heartbeat.
        """
        if self.needs_reset:
            return f"stopped ({self.why}): reset first, so that the robot stands, then arm"
        if self.page_lost(now):
            self._left, self._holder = self._holder, None
        self.stopped, self.armed, self.reason, self.why = False, True, "", ""
        self._armed_at = now
        return ""

    def disarm(self) -> None:
        """Rest, without damping."""
        self.armed = False

    def take_control(self, page: str, now: float) -> None:
        """`page` holds control: its heartbeats are watched from now on."""
        self._holder, self._beat_at, self._left = page, now, None

    def release_control(self, page: str) -> None:
        """`page` gave control up in good order: nothing is watched."""
        if page == self._holder:
            self._holder = None
        if page == self._left:
            self._left = None

    def beat(self, page: str, now: float) -> None:
        """A heartbeat of a page. Any thread."""
        if page == self._left:
            self.take_control(page, now)
        if page == self._holder:
            self._beat_at = now

    def page_lost(self, now: float) -> bool:
        """A page holds control and has gone silent."""
        return self._holder is not None and now - self._beat_at >= PAGE_LOST_AFTER - EPS

    def silent(self, page: str, now: float) -> bool:
        """`page` held control and has gone silent, whether or not somebody armed since."""
        return page == self._left or (page == self._holder and self.page_lost(now))

    # What is known of the person and of this computer ---------------------------------------------

    def see(self, now: float) -> None:
        """A human pose came that is believed."""
        self.seen_at = now

    def forget_person(self) -> None:
        """Another person, or another source, from here on."""
        self.seen_at = None

    def stale_s(self, now: float) -> float | None:
        """s since the last human pose, None before the first."""
        return None if self.seen_at is None else now - self.seen_at

    def period(self, *, late: bool) -> None:
        """A control period has ended, after its deadline or before."""
        self._late.append(late)
        share = sum(self._late) / OVERRUN_WINDOW
        if share > OVERRUN_SHARE:
            self.overrun = True
        elif share < 1.0 - OVERRUN_SHARE:
            self.overrun = False

    # The decision -------------------------------------------------------------------------------

    def command(
        self,
        now: float,
        mode: str,
        *,
        source_ended: bool = False,
        keep: tuple[Reason, str] = ("", ""),
    ) -> DriveCommand:
        """What the puppeteer must do in this period, and why.

        now: s, on the one clock of all times here. mode: the loop's. source_ended: the source has
        nothing more to give. keep: why the robot goes nowhere though the person is seen, or two "".
        """
        ramp = None
        if self._armed_at is not None and now - self._armed_at < ARM_RAMP:
            ramp = ARM_RAMP
        directive, reason, why = self._decide(now, mode, source_ended, keep)
        return DriveCommand(
            directive=directive,
            damping=self.stopped and self.needs_reset,
            ramp=ramp,
            mode=mode,
            reason=reason,
            why=why,
        )

    @property
    def stop_line(self) -> str:
        """Why the robot is stopped and what would free it, "" if it is not."""
        if not self.stopped:
            return ""
        then = "reset, then arm" if self.needs_reset else "the robot is up, arm to go on"
        if self._rises_at is not None:
            then = f"it stands up by itself after {DEMO_LIES:.0f} s"
        return f"stopped: {self.why}; {then}"

    def _decide(
        self, now: float, mode: str, source_ended: bool, keep: tuple[Reason, str]
    ) -> Decision:
        if self.stopped:
            return Directive.STAND, self.reason, self.stop_line
        if mode == "idle":
            then = "choose live to follow" if self.armed else "arm to follow the person"
            return Directive.REST, "idle", f"idle: {then}"
        if not self.armed:
            return Directive.REST, "unarmed", "unarmed: arm to follow the person"
        if self.page_lost(now):
            line = "page lost: the page in control has gone silent"
            return Directive.STAND, "page_lost", line
        if source_ended:
            return Directive.STAND, "source_ended", "ended: the source has no more motion"
        reason, line = missing(math.inf if self.seen_at is None else now - self.seen_at)
        if reason:
            return Directive.REST if reason == "nobody" else Directive.STAND, reason, line
        if keep[0]:
            return Directive.STAND if self.overrun else Directive.KEEP, *keep
        if self.overrun:
            return Directive.STAND, "overrun", "overrun: this computer cannot keep 30 Hz"
        return Directive.FOLLOW, "", ""
