"""Everything that may keep the robot from following the person, in one place: when, and how.

    human data older than 100 ms   the last pose is used again
                           300 ms   hold; while walking, swing feet down within 150 ms
                           500 ms   stand
    page in control silent  400 ms   stand (begun within 0.5 s of its loss)
    emergency stop, fall, fault      damping, latched: reset (stand up), then arm (1 s ramp)
    fall of the page's own demo      damping; 3 s later it stands up and goes on, unless stopped

It decides from times and flags that it is told, never from a clock of its own.
"""

from dataclasses import dataclass

from studio.control.command import Orders
from studio.control.controller import Directive

HOLD_AFTER = 0.3
STAND_AFTER = 0.5
PAGE_LOST_AFTER = 0.4
ARM_RAMP = 1.0
DEMO_LIES = 3.0
"""s."""
_EPS = 1e-9


def stale_directive(age: float) -> Directive:
    """What a human pose `age` s old calls for (infinite: none was ever seen)."""
    if age >= STAND_AFTER - _EPS:
        return Directive.STAND
    return Directive.HOLD if age >= HOLD_AFTER - _EPS else Directive.FOLLOW


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What is known at one control period. Times on one clock, in s.

    mode: the loop's. human_at: when the last human pose came, None before the first.
    source_ended: the source has nothing more to give. overrun: the loop cannot keep its rate.
    """

    now: float
    mode: str
    human_at: float | None
    source_ended: bool = False
    overrun: bool = False


class Safety:
    """Remembers the latches: stopped, armed, who holds control. Only the loop's thread calls it,
    but for `beat`, which any thread may."""

    def __init__(self, *, armed: bool = False) -> None:
        self.stops = 0  # so far: presses, falls and faults
        self.stopped = False
        self.needs_reset = False
        self.armed = armed
        self.reason = ""
        self.falls = 0
        self._rises_at: float | None = None
        self._armed_at: float | None = None
        self._holder: str | None = None
        self._left: str | None = None
        self._beat_at = 0.0

    # Latches ------------------------------------------------------------------------------------

    def stop(self, reason: str) -> None:
        """Damping, latched until reset and arm."""
        self.stopped, self.needs_reset, self.armed = True, True, False
        self.reason = reason
        self.stops += 1
        self._rises_at = None

    def fall(self, now: float, *, demo: bool) -> None:
        """The robot fell: as a stop. demo: nobody drives it, it may stand up by itself."""
        again = not self.stopped
        self.falls += 1
        self.stop("the robot fell")
        if demo and again:
            self._rises_at = now + DEMO_LIES

    def rises(self, now: float, *, demo: bool) -> bool:
        """It is time for a fallen demo to stand up; no longer, once somebody else drives."""
        if not demo:
            self._rises_at = None
        return self._rises_at is not None and now >= self._rises_at - _EPS

    def reset(self) -> None:
        """The robot stands up; a latched stop stays."""
        self.needs_reset, self._rises_at = False, None

    def arm(self, now: float) -> str:
        """Release the latch; the robot follows again over a ramp. Why not, or "".

        Whoever arms takes the place of a page that has gone silent: it is watched again from its
        next heartbeat.
        """
        if self.needs_reset:
            return f"stopped ({self.reason}): reset first, so that the robot stands, then arm"
        if self.page_lost(now):
            self._left, self._holder = self._holder, None
        self.stopped, self.armed, self.reason = False, True, ""
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
        return self._holder is not None and now - self._beat_at >= PAGE_LOST_AFTER - _EPS

    # The decision -------------------------------------------------------------------------------

    def orders(self, s: Situation) -> Orders:
        """What the puppeteer must do in this period, with the one line that says why."""
        ramp = None
        if self._armed_at is not None and s.now - self._armed_at < ARM_RAMP:
            ramp = ARM_RAMP
        directive, damping, why = self._decide(s)
        return Orders(directive=directive, damping=damping, ramp=ramp, mode=s.mode, why=why)

    @property
    def stop_line(self) -> str:
        """Why the robot is stopped and what would free it, "" if it is not."""
        if not self.stopped:
            return ""
        then = "reset, then arm" if self.needs_reset else "the robot is up, arm to go on"
        if self._rises_at is not None:
            then = f"it stands up by itself after {DEMO_LIES:.0f} s"
        return f"stopped: {self.reason}; {then}"

    def _decide(self, s: Situation) -> tuple[Directive, bool, str]:
        if self.stopped:
            return Directive.STAND, self.needs_reset, self.stop_line
        if s.mode == "idle":
            why = "idle: " + ("choose live to follow" if self.armed else "arm to follow the person")
            return Directive.REST, False, why
        if not self.armed:
            return Directive.REST, False, "unarmed: arm to follow the person"
        if self.page_lost(s.now):
            return Directive.STAND, False, "page lost: the page in control has gone silent"
        if s.source_ended:
            return Directive.STAND, False, "ended: the source has no more motion"
        if s.human_at is None:
            return Directive.REST, False, "stale: no human pose yet"
        age = s.now - s.human_at
        directive = stale_directive(age)
        if directive is not Directive.FOLLOW:
            return directive, False, f"stale: no human pose for {age:.1f} s"
        if s.overrun:
            return Directive.HOLD, False, "overrun: this computer cannot keep 30 Hz"
        return Directive.FOLLOW, False, ""


def stale_orders(age: float) -> Orders:
    """For a drive without a page or a button: only the person can go missing (`age` s ago)."""
    directive = stale_directive(age)
    if age == float("inf"):  # nobody yet is no reason to move
        return Orders(why="stale: no human pose yet")
    why = "" if directive is Directive.FOLLOW else f"stale: no human pose for {age:.1f} s"
    return Orders(directive=directive, why=why)
