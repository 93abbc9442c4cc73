"""A take shown again, as recorded or as its edits leave it: at any speed, paused, in a loop."""

from dataclasses import replace
from pathlib import Path

from studio.live.playhead import EPS, Playhead
from studio.robot.a1 import CONTROL_DT
from studio.takes.columns import Columns
from studio.takes.edit.edited import Viewed, open_table
from studio.takes.edit.edits import Edits
from studio.takes.tick import Tick


class Replay(Playhead):
    """Remembers the time shown, its place.

    Without edits it plays at once; under review it waits at the start of the trim.
    name: of the take. range: (start, end) s within which it plays and loops.
    aligned: whether the person is where lag and warp put them; None without edits.
    """

    speeds = (0.1, 4.0)  # nothing but the eye has to follow

    def __init__(
        self, name: str, table: Columns, edits: Edits | None = None, *, aligned: bool = True
    ) -> None:
        """As `takes.edit.edited.Viewed`: StudioError for a take without ticks."""
        self._take = Viewed(name, table, edits, aligned=aligned)
        self._shown = -1
        self.name = name
        self.aligned = None if edits is None else aligned
        length = self._take.seconds
        start, end = (edits.trim if edits else None) or (0.0, length)
        self.range = (min(start, length), min(end, length))
        super().__init__(length, start=self.range[0], playing=edits is None)

    @property
    def runs(self) -> bool:
        """It plays."""
        return self.playing

    @property
    def over(self) -> bool:
        """The range has been shown, or what comes after it."""
        return self.place >= self.range[1] - EPS

    @property
    def ended(self) -> bool:
        """Playing has come to its end."""
        return not self.playing and self.over

    def step(self) -> Tick:
        """The tick to show in this control period, the person new only if it is another row."""
        tick = self._take.at(self._advance())
        new, self._shown = tick.index != self._shown, tick.index
        doing = "replay: paused or at its end" if self.aligned is None else "review: paused"
        why = "" if self.playing else f"{doing}; play, or choose live"
        return replace(tick, mode="replay", why=why, human_fresh=tick.human_fresh and new)

    def _advance(self) -> float:
        """The time (s) to show in this control period; then time goes on, if it plays."""
        t = self.place
        if self.playing:
            end = self.range[1] if t <= self.range[1] + EPS else self.length
            if t < end - EPS:
                self.place = min(t + CONTROL_DT * self.speed, end)
            elif self.loop:
                self.place = self.start
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
