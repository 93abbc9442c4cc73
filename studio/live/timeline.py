"""Where a source of known length is played: one clock that is paused, moved, sped up, looped."""

import numpy as np

from studio.errors import StudioError
from studio.robot.a1 import CONTROL_DT

SPEEDS = (0.1, 2.0)
"""Slowest and fastest, times real time: few people move faster than twice as fast."""
TOLERANCE = 0.5 * CONTROL_DT
"""s: nearer to its end a clip is over, as sources say it (`mocap.clip_source`)."""
JUMP = 0.1
"""s: who is taken further than this has moved as nobody moves."""
_EPS = 1e-9


class Timeline:
    """Remembers the place in a source. Only the loop's thread calls it.

    length, place: s. playing: what was asked for; a stop holds it all the same. speed: times real
    time. moved: it was not played straight on, so that the source's own order tells nothing.
    ended: nothing more will come. The fields are read by others, and set here.
    """

    start = 0.0

    def __init__(self, length: float) -> None:
        self.length, self.place = length, 0.0
        self.playing, self.loop, self.speed = True, False, 1.0
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
        if not self._over:
            return
        if self.loop and loops and not still:
            self._go(self.start)
        elif self.moved:  # else the source says so
            self.end()

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Go to `t` s, play or pause, at a speed (0.1 to 2), again and again.

        What is over is played from its start. StudioError for another speed, and then nothing
        changes.
        """
        if speed is not None:
            if not SPEEDS[0] - _EPS <= speed <= SPEEDS[1] + _EPS:
                raise StudioError(
                    f"speed must be between {SPEEDS[0]:g} and {SPEEDS[1]:g}, not {speed}"
                )
            self.speed, self.moved = speed, True
        if loop is not None:
            self.loop = loop
        if t is not None:
            self._go(t)
        if playing is not None:
            if playing and self._over:
                self._go(self.start)
            self.playing = playing

    def end(self) -> None:
        """Nothing more will come until it is moved."""
        self.place, self.playing, self.ended, self.moved = self.length, False, True, True

    def jumped(self) -> bool:
        """Whether, since this was last asked, the person was taken elsewhere or has begun to move:
        what was seen of them before tells nothing of what they do now."""
        jumped, self._jumped = self._jumped, False
        return jumped

    @property
    def _over(self) -> bool:
        return self.place + TOLERANCE >= self.length - _EPS

    def _go(self, place: float) -> None:
        place = float(np.clip(place, 0.0, self.length))
        self._jumped |= abs(place - self.place) > JUMP
        self.place, self.moved, self.ended = place, True, False
