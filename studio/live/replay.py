"""A recorded take shown again: as it was, or under review as its edits leave it; at any speed."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.errors import StudioError
from studio.robot.a1 import CONTROL_DT
from studio.takes.columns import Columns
from studio.takes.edit.edited import open_table
from studio.takes.edit.edits import Edits
from studio.takes.edit.viewed import Viewed
from studio.takes.names import take_folder
from studio.takes.take import read_take
from studio.takes.tick import Tick

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


class Replay(Transport):
    """Holds the take's ticks; plays from the start at once."""

    def __init__(self, name: str, ticks: list[Tick]) -> None:
        """StudioError for a take without ticks."""
        if not ticks:
            raise StudioError(f"take {name!r} holds no ticks: nothing to replay")
        # Ticks are one control period apart, whatever their source's clock did.
        self._t = (np.array([tick.index for tick in ticks]) - ticks[0].index) * CONTROL_DT
        self._ticks, self._shown = ticks, -1
        super().__init__(name, self._t[-1], playing=True)

    def step(self) -> Tick:
        """The tick to show in this control period, its mode and `why` set."""
        i = max(int(np.searchsorted(self._t, self.advance() + 1e-9)) - 1, 0)
        new, self._shown = i != self._shown, i
        tick = self._ticks[i]
        why = "" if self.playing else "replay: paused or at its end; play, or choose live"
        return replace(tick, mode="replay", why=why, human_fresh=tick.human_fresh and new)


class Playback(Transport):
    """Paused at the start of the take's trim until somebody plays it."""

    def __init__(self, name: str, table: Columns, edits: Edits, *, aligned: bool = True) -> None:
        """As `recording.viewed`: StudioError for a take without ticks."""
        self._take = Viewed(name, table, edits, aligned=aligned)
        self.aligned, self._shown = aligned, -1
        super().__init__(name, self._take.seconds, edits.trim)

    def step(self) -> Tick:
        """The tick to show in this control period, its person new only if it is another row."""
        tick = self._take.at(self.advance())
        new, self._shown = tick.index != self._shown, tick.index
        why = "" if self.playing else "review: paused; play, or choose live"
        return replace(tick, human_fresh=new, why=why)


def open_replay(sessions: Path, name: str) -> Replay:
    """Read a take's ticks; any thread. StudioError if there is none of that name."""
    return Replay(name, read_take(take_folder(sessions, name)).ticks)


def open_playback(sessions: Path, name: str, *, aligned: bool = True) -> Playback:
    """Read a take for review; any thread. StudioError if there is none of that name."""
    table, edits = open_table(sessions, name)
    return Playback(name, table, edits, aligned=aligned)
