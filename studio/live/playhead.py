"""The place in what is played, a source or a take: paused, moved, sped up, looped."""

from typing import ClassVar

import numpy as np

from studio.errors import StudioError

EPS = 1e-9


class Playhead:
    """Only the loop's thread calls it. Fields are read by others, and set here.

    start: s, from where what is over is played again. place, length: s. playing: what was asked
    for. speed: times real time.
    """

    speeds: ClassVar[tuple[float, float]]
    """Slowest and fastest, times real time."""

    def __init__(self, length: float, *, start: float = 0.0, playing: bool = True) -> None:
        self.start, self.place, self.length = start, start, length
        self.playing, self.loop, self.speed = playing, False, 1.0

    @property
    def over(self) -> bool:
        """There is nothing to play from this place on."""
        raise NotImplementedError

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Go to `t` s, play or pause, at a speed, again and again; what is None stays.

        What is over is played from its start. StudioError for a speed beyond `speeds`, and then
        nothing changes.
        """
        slowest, fastest = self.speeds
        if speed is not None:
            if not slowest - EPS <= speed <= fastest + EPS:
                raise StudioError(f"speed must be between {slowest:g} and {fastest:g}, not {speed}")
            self.speed = speed
        if loop is not None:
            self.loop = loop
        if t is not None:
            self.go(t)
        if playing is not None:
            if playing and self.over:
                self.go(self.start)
            self.playing = playing

    def go(self, place: float) -> None:
        """To this place, s, or the nearest there is."""
        self.place = float(np.clip(place, 0.0, self.length))
