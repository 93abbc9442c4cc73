"""The MOTION of a BVH file: lines → rows of channels, a block at a time; bad rows are left out."""

import logging
import math
from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.mocap.source_report import Refused
from studio.mocap.text import MAX_FRAMES, Lines

Array = NDArray[np.float64]
Indices = NDArray[np.int64]
log = logging.getLogger(__name__)

MAX_VALUE = 1e9
"""No position and no angle is larger."""
BLOCK = 1024
"""Frames turned into joints at a time."""


def read_timing(lines: Lines) -> tuple[int, float]:
    """Frames claimed and seconds a frame, of "Frames: 12" and "Frame Time:.01" however spaced.

    Raises StudioError for other words, and for what is no count or no usable time.
    """
    values = []
    for key, example in (("frames:", "Frames: N"), ("frametime:", "Frame Time: SECONDS")):
        text = "".join(next(lines.rows(), [])).lower()
        if not text.startswith(key):
            raise lines.error(f"expected {example!r}")
        values.append(lines.finite(text[len(key) :]))
    frames, dt = values
    if not (frames >= 0 and frames == int(frames)):
        raise lines.error(f"Frames: {frames:g} is no count")
    if not 1e-4 <= dt <= 1.0:
        raise lines.error(f"Frame Time: {dt:g} s; 0.0001 to 1 would work")
    return int(frames), dt


class MotionRows:
    """The rows after the timing, once. count: frames so far, those refused included.

    A row may be wrapped over several lines as long as each begins on a line of its own. One that
    holds what is no finite number is refused and counted; a last one that the end of the file cuts
    is dropped; any other that is too long or too short is an error, for what it says is unknown.
    """

    def __init__(self, lines: Lines, num_channels: int) -> None:
        self._lines, self._channels = lines, num_channels
        self.count = 0
        self.refused = Refused()

    def blocks(self) -> Iterator[tuple[Indices, Array]]:
        """Numbers (≤ BLOCK,) of the good frames and their rows (≤ BLOCK, C), all finite.

        Raises StudioError for a row of the wrong length, and past MAX_FRAMES.
        """
        numbers: list[int] = []
        rows: list[Array] = []
        for words in self._rows():
            row = self._row(words)
            if row is not None:
                numbers.append(self.count)
                rows.append(row)
            self.count += 1
            if self.count > MAX_FRAMES:
                raise self._lines.error(f"more than {MAX_FRAMES} frames")
            if len(rows) == BLOCK:
                yield np.array(numbers), np.array(rows)
                numbers, rows = [], []
        if rows:
            yield np.array(numbers), np.array(rows)

    def _rows(self) -> Iterator[list[str]]:
        """The words of each row; whether rows are wrapped shows in the first."""
        wrapped, row = True, []
        for words in self._lines.rows():
            row = row + words if row and wrapped else words
            if len(row) == self._channels:
                if self.count == 0:
                    wrapped = row is not words
                yield row
                row = []
            elif len(row) > self._channels or not wrapped:
                self._no_more(row)
                row = []
        if row:
            self._cut(row)

    def _no_more(self, row: list[str]) -> None:
        """A row of the wrong length must be the last line, cut short; else it is an error."""
        error = self._error(row)
        if len(row) > self._channels or next(self._lines.rows(), None) is not None:
            raise error
        self._cut(row)

    def _cut(self, row: list[str]) -> None:
        if self.count == 0:
            raise self._error(row)
        log.warning("%s: the last frame is cut short and left out", self._lines.name)

    def _error(self, row: list[str]) -> StudioError:
        return self._lines.error(f"{len(row)} values; the joints have {self._channels} channels")

    def _row(self, words: list[str]) -> Array | None:
        """The numbers of a row, or None where one is none: then the frame is refused."""
        try:
            row = np.array([float(word) for word in words])
        except ValueError:
            row = np.array([math.nan])
        if np.abs(row).max() <= MAX_VALUE:  # not so for NaN
            return row
        try:
            for word in words:
                if abs(self._lines.finite(word)) > MAX_VALUE:
                    raise self._lines.error(f"{word[:40]!r} is no position and no angle")
        except StudioError as error:
            self.refused = self.refused.plus(str(error).removeprefix(f"{self._lines.name}, "))
        return None
