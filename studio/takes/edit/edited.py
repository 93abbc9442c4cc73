"""A take's table as its edits leave it: what is kept, who belongs to a tick, a row as a Tick."""

from dataclasses import replace
from math import ceil
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.robot import a1
from studio.takes.columns import Columns, columns, tick_of
from studio.takes.edit import edits as edit_log
from studio.takes.edit.edits import Edits
from studio.takes.session_library import SessionLibrary
from studio.takes.tick import Tick

Array = NDArray[np.float64]


def open_table(sessions: Path, name: str) -> tuple[Columns, Edits]:
    """A take's table and edits, by name. StudioError for a take without ticks, too."""
    return open_folder(SessionLibrary(sessions).folder(name))


def open_folder(folder: Path) -> tuple[Columns, Edits]:
    """The same by its folder, which may lie in the bin."""
    table = columns(folder)
    if not len(table):
        raise StudioError(f"take {folder.name} holds no tick that could be read: delete it")
    return table, edit_log.read_edits(folder).edits


def trimmed(ticks: int, edits: Edits) -> tuple[int, int]:
    """First tick at or after the trim's start, and first at or after its end."""
    if edits.trim is None:
        return 0, ticks
    start, end = (ceil(s * a1.CONTROL_HZ - 1e-6) for s in edits.trim)
    return min(start, ticks), min(end, ticks)


def kept(ticks: int, edits: Edits) -> NDArray[np.bool_]:
    """(T,) which ticks the trim and the cuts leave."""
    t = np.arange(ticks) / a1.CONTROL_HZ
    out = np.zeros(ticks, dtype=bool)
    out[slice(*trimmed(ticks, edits))] = True
    for start, end in edits.cuts or ():
        out &= (t < start - 1e-9) | (t > end + 1e-9)
    return out


def ends(table: Columns, edits: Edits) -> tuple[int, int]:
    rows = np.flatnonzero(kept(len(table), edits))
    return (int(rows[0]), int(rows[-1]) + 1) if len(rows) else (0, 0)


def human_rows(ticks: NDArray[np.int64], edits: Edits) -> Array:
    """Fractional row (N,) of the human that belongs to the robot at these ticks (N,)."""
    shift = np.full(len(ticks), edits.lag or 0.0)
    if edits.warp:
        t, more = np.array(edits.warp).T
        shift = shift + np.interp(ticks / a1.CONTROL_HZ, t, more)
    return ticks + shift * a1.CONTROL_HZ


def human_at(table: Columns, at: Array) -> tuple[Array, Array]:
    """Joints (N, 19, 3) m and confidence (N, 19) at fractional rows (N,), linear between rows.

    Beyond the take's ends its first and last pose stand; without a person NaN and 0.
    """
    at = np.clip(at, 0, len(table) - 1)
    low = np.floor(at).astype(int)
    high = np.ceil(at).astype(int)
    first = int(low.min(initial=0))
    rows = table.rows[first : int(high.max(initial=0)) + 1]
    w = (at - low)[:, None, None]
    pos, confidence = rows["human"], rows["confidence"]
    return (
        (1.0 - w) * pos[low - first] + np.where(w > 0.0, w * pos[high - first], 0.0),
        np.minimum(confidence[low - first], confidence[high - first]).astype(np.float64),
    )


class Viewed:
    """A take at any time, as recorded or as its edits leave it: a row of its table as a Tick.

    Rows are read as they are needed (`takes.columns`): an hour is as near as a minute. edits: None
    for the take as it was recorded, the person when they were seen. aligned: the person as lag and
    warp put them; else in the row in which they were recorded.
    """

    def __init__(
        self, name: str, table: Columns, edits: Edits | None = None, *, aligned: bool = True
    ) -> None:
        """StudioError for a take without ticks."""
        if not len(table):
            raise StudioError(f"take {name!r} holds no ticks: nothing to show")
        self._table, self._edits, self.aligned = table, edits, aligned
        self.seconds = (len(table) - 1) * a1.CONTROL_DT

    def at(self, t: float) -> Tick:
        """The take at `t` s, to the nearest row."""
        i = int(np.clip(round(t / a1.CONTROL_DT), 0, len(self._table) - 1))
        tick = tick_of(self._table, i, self._human(i))
        if self._edits is None:
            return tick
        # The person of another row is as new in each.
        return replace(tick, mode="replay", controller="recorded", human_fresh=True)

    def _human(self, i: int) -> HumanPose | None:
        edits, t = self._edits, i * a1.CONTROL_DT
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
