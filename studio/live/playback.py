"""A take under review, shown again as its edits leave it: at any speed, paused, in a loop."""

from dataclasses import replace

from studio.live.transport import Transport
from studio.takes.columns import Columns
from studio.takes.edit.edits import Edits
from studio.takes.edit.viewed import Viewed
from studio.takes.tick import Tick


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
