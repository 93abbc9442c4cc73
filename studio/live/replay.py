"""A recorded take shown again: its ticks, at any speed, paused or sought."""

from dataclasses import replace

import numpy as np

from studio.errors import StudioError
from studio.live.transport import Transport
from studio.robot.a1 import CONTROL_DT
from studio.takes.tick import Tick


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
