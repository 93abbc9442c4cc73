"""Where in a take a showing is: play, pause, speed, loop, seek; alike for every way to show one."""

import numpy as np

from studio.errors import StudioError
from studio.robot.a1 import CONTROL_DT

SPEEDS = (0.1, 4.0)
"""Slowest and fastest, times real time."""
_EPS = 1e-9


class Transport:
    """Remembers the time shown. Only the loop's thread calls it, but for its making.

    name: of the take. seconds: its length. range: (start, end) s within which it plays and loops.
    """

    def __init__(
        self,
        name: str,
        seconds: float,
        range: tuple[float, float] | None = None,
        *,
        playing: bool = False,
    ) -> None:
        self.name, self.seconds = name, float(seconds)
        start, end = range or (0.0, self.seconds)
        self.range = (min(start, self.seconds), min(end, self.seconds))
        self.t, self.playing, self.speed, self.loop = self.range[0], playing, 1.0, False

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Go to `t` s, play or pause, at a speed (0.1 to 4), again and again within the range.

        StudioError for another speed, and then nothing changes.
        """
        if speed is not None:
            if not SPEEDS[0] - _EPS <= speed <= SPEEDS[1] + _EPS:
                raise StudioError(
                    f"speed must be between {SPEEDS[0]} and {SPEEDS[1]:g}, not {speed}"
                )
            self.speed = speed
        if loop is not None:
            self.loop = loop
        if t is not None:
            self.t = float(np.clip(t, 0.0, self.seconds))
        if playing is not None:
            self.playing = playing
            if playing and self.t >= self.range[1] - _EPS:
                self.t = self.range[0]

    def advance(self) -> float:
        """The time (s) to show in this control period; then time goes on, if it plays."""
        t = self.t
        if self.playing:
            end = self.range[1] if t <= self.range[1] + _EPS else self.seconds
            if t < end - _EPS:
                self.t = min(t + CONTROL_DT * self.speed, end)
            elif self.loop:
                self.t = self.range[0]
            else:
                self.playing = False
        return t
