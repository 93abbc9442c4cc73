"""A take shown again, as recorded or as its edits leave it: at any speed, paused, in a loop."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.errors import StudioError
from studio.robot.a1 import CONTROL_DT
from studio.takes.columns import Columns
from studio.takes.edit.edited import Viewed, open_table
from studio.takes.edit.edits import Edits
from studio.takes.tick import Tick

SPEEDS = (0.1, 4.0)
"""Slowest and fastest, times real time."""
_EPS = 1e-9


class Replay:
    """Remembers the time shown. Only the loop's thread calls it, but for its making.

    Without edits it plays at once; under review it waits at the start of the trim.
    name: of the take. seconds: its length. range: (start, end) s within which it plays and loops.
    aligned: whether the person is where lag and warp put them; None without edits.
    """

    def __init__(
        self, name: str, table: Columns, edits: Edits | None = None, *, aligned: bool = True
    ) -> None:
        """As `takes.edit.edited.Viewed`: StudioError for a take without ticks."""
        self._take = Viewed(name, table, edits, aligned=aligned)
        self._shown = -1
        self.name, self.seconds = name, self._take.seconds
        self.aligned = None if edits is None else aligned
        start, end = (edits.trim if edits else None) or (0.0, self.seconds)
        self.range = (min(start, self.seconds), min(end, self.seconds))
        self.t, self.playing, self.speed, self.loop = self.range[0], edits is None, 1.0, False

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

    # As the one transport sees it (`commands.transport`).

    @property
    def start(self) -> float:
        """s, from where it is played again."""
        return self.range[0]

    @property
    def place(self) -> float:
        """The time shown, s."""
        return self.t

    @property
    def length(self) -> float:
        """s."""
        return self.seconds

    @property
    def runs(self) -> bool:
        """It plays."""
        return self.playing

    @property
    def ended(self) -> bool:
        """Playing has come to its end."""
        return not self.playing and self.t >= self.range[1] - _EPS

    def step(self) -> Tick:
        """The tick to show in this control period, the person new only if it is another row."""
        tick = self._take.at(self._advance())
        new, self._shown = tick.index != self._shown, tick.index
        doing = "replay: paused or at its end" if self.aligned is None else "review: paused"
        why = "" if self.playing else f"{doing}; play, or choose live"
        return replace(tick, mode="replay", why=why, human_fresh=tick.human_fresh and new)

    def _advance(self) -> float:
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


def open_replay(sessions: Path, name: str) -> Replay:
    """A take as it was recorded; any thread. StudioError if there is none of that name."""
    table, _ = open_table(sessions, name)
    return Replay(name, table)


def open_review(sessions: Path, name: str, *, aligned: bool = True) -> Replay:
    """A take for review; any thread. StudioError if there is none of that name."""
    table, edits = open_table(sessions, name)
    return Replay(name, table, edits, aligned=aligned)
