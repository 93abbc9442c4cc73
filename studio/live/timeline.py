"""Where a source of known length is played: one clock that is paused, moved, sped up, looped."""

from studio.live.playhead import EPS, Playhead
from studio.mocap.clip_source import TOLERANCE

JUMP = 0.1
"""s: who is taken further than this has moved as nobody moves."""


class Timeline(Playhead):
    """Remembers the place in a source; a stop holds it, whether it is asked to play or not.

    moved: it was not played straight on, so that the source's own order tells nothing. ended:
    nothing more will come.
    """

    speeds = (0.1, 2.0)  # few people move faster than twice as fast

    def __init__(self, length: float) -> None:
        super().__init__(length)
        self.moved = self.ended = False
        self._held = self._jumped = self._still = False
        self._t = 0.0

    @property
    def runs(self) -> bool:
        """The place moves on."""
        return self.playing and not self._held and not self.ended

    @property
    def passed(self) -> float:
        """s since the source began, on the loop's clock, as of the last `advance`."""
        return self._t

    def advance(
        self, t: float, *, held: bool = False, waits: bool = False, loops: bool = True
    ) -> None:
        """It is `t` s since the source began. held: by a stop. waits: for the robot, for a moment.
        loops: it may begin anew by itself."""
        dt, self._t = t - self._t, t
        self._held = held
        still = waits or not self.runs
        self._jumped |= self._still and not still  # the robot had nothing to follow meanwhile
        self._still = still
        self.moved |= still
        if not self.moved:
            self.place = min(t, self.length)
        elif not still:
            self.place = min(self.place + self.speed * dt, self.length)
        if not self.over:
            return
        if self.loop and loops and not still:
            self.go(self.start)
        elif self.moved:  # else the source says so
            self.end()

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """As every playhead; at another speed it is not played straight on."""
        super().seek(t, playing, speed, loop)
        self.moved |= speed is not None

    def end(self) -> None:
        """Nothing more will come until it is moved."""
        self.place, self.playing, self.ended, self.moved = self.length, False, True, True

    def jumped(self) -> bool:
        """Whether, since this was last asked, the person was taken elsewhere or has begun to move:
        what was seen of them before tells nothing of what they do now."""
        jumped, self._jumped = self._jumped, False
        return jumped

    @property
    def over(self) -> bool:
        """It is as near to its end as a source that says so."""
        return self.place + TOLERANCE >= self.length - EPS

    def go(self, place: float) -> None:
        """To this place, s; what has ended goes on."""
        before = self.place
        super().go(place)
        self._jumped |= abs(self.place - before) > JUMP
        self.moved, self.ended = True, False
