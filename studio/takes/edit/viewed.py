"""A take seen at any time, as recorded or as its edits leave it: a row of its table as a Tick.

Rows are read from the table as they are needed (`takes.columns`), so an hour is as near as a
minute.
"""

from dataclasses import replace

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.robot.a1 import CONTROL_DT
from studio.takes.columns import Columns, tick_of
from studio.takes.edit.edited import human_at, human_rows
from studio.takes.edit.edits import Edits
from studio.takes.tick import Tick


class Viewed:
    """edits: None for the take as it was recorded, the person when they were seen. aligned: the
    person as lag and warp put them; else in the row in which they were recorded."""

    def __init__(
        self, name: str, table: Columns, edits: Edits | None = None, *, aligned: bool = True
    ) -> None:
        """StudioError for a take without ticks."""
        if not len(table):
            raise StudioError(f"take {name!r} holds no ticks: nothing to show")
        self._table, self._edits, self.aligned = table, edits, aligned
        self.seconds = (len(table) - 1) * CONTROL_DT

    def at(self, t: float) -> Tick:
        """The take at `t` s, to the nearest row."""
        i = int(np.clip(round(t / CONTROL_DT), 0, len(self._table) - 1))
        tick = tick_of(self._table, i, self._human(i))
        if self._edits is None:
            return tick
        # The person of another row is as new in each.
        return replace(tick, mode="replay", controller="recorded", human_fresh=True)

    def _human(self, i: int) -> HumanPose | None:
        edits, t = self._edits, i * CONTROL_DT
        if edits is None:
            t = float(self._table.rows["human_t"][i])
        at = np.array([float(i)])
        if edits is not None and self.aligned:
            at = human_rows(np.array([i]), edits)
        joints, confidence = human_at(self._table, at)
        if not np.isfinite(joints).all():
            return None
        return HumanPose(
            t=t,
            joint_pos_w=np.asarray(joints[0], dtype=np.float64),
            confidence=np.asarray(confidence[0], dtype=np.float64),
        )
