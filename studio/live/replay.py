"""A recorded take shown again: its ticks, at any speed, paused or sought."""

from dataclasses import replace

import numpy as np

from studio.errors import StudioError
from studio.recording.tick import Tick
from studio.robot.a1 import CONTROL_DT


class Replay:
    """Remembers where in the take it is. Only the loop's thread calls it."""

    def __init__(self, name: str, ticks: list[Tick]) -> None:
        """StudioError for a take without ticks."""
        if not ticks:
            raise StudioError(f"take {name!r} holds no ticks: nothing to replay")
        self.name, self._ticks = name, ticks
        # Ticks are one control period apart, whatever their source's clock did.
        self._t = (np.array([tick.index for tick in ticks]) - ticks[0].index) * CONTROL_DT
        self.seconds = float(self._t[-1])
        self.t, self.playing, self.speed, self.loop = 0.0, True, 1.0, False
        self._shown = -1

    def seek(
        self,
        t: float | None = None,
        playing: bool | None = None,
        speed: float | None = None,
        loop: bool | None = None,
    ) -> None:
        """Go to `t` s, play or pause, at a speed (0.1 to 4), in a loop; or StudioError."""
        self.loop = self.loop if loop is None else loop
        if speed is not None:
            if not 0.1 <= speed <= 4.0:
                raise StudioError(f"speed must be between 0.1 and 4, not {speed}")
            self.speed = speed
        if t is not None:
            self.t = float(np.clip(t, 0.0, self.seconds))
        if playing is not None:
            self.playing = playing
            if playing and self.t >= self.seconds:
                self.t = 0.0

    def step(self) -> Tick:
        """The tick to show in this control period, its mode and `why` set."""
        i = max(int(np.searchsorted(self._t, self.t + 1e-9)) - 1, 0)
        if self.t >= self.seconds:
            self.playing, self.t = self.playing and self.loop, 0.0 if self.loop else self.t
        elif self.playing:
            self.t = min(self.t + CONTROL_DT * self.speed, self.seconds)
        new, self._shown = i != self._shown, i
        tick = self._ticks[i]
        why = "" if self.playing else "replay: paused or at its end; play, or choose live"
        return replace(tick, mode="replay", why=why, human_fresh=tick.human_fresh and new)
