"""What repeats itself goes on: a march whose frames are lost, a gait that comes to rest in steps.

Held still in mid-stride instead, a march looks like a halt, and a robot that walks at 1 m/s and is
told so trips: of the falls with frames lost this was the larger part. The nearest likeness in the
last two seconds goes on as it went on then.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

MEMORY = 60
"""Control periods that are remembered (2 s)."""
LIKENESS = 8
"""Control periods that have to be alike (0.27 s) ..."""
PERIODS = (9, 51)
"""... and how many periods ago that may have been: strides of 0.3 to 1.7 s."""
ALIKE = 0.25
"""Largest share of the motion's own variance by which they may differ."""
MOVES = 0.02
"""m: points that spread less than this about their mean do nothing to be continued."""
FORGET = 0.8
"""Share of the gap between the present and the past that is kept from one period to the next."""


class PeriodicExtrapolator:
    """Remembers points (J, 3) m, a control period each; one thread."""

    def __init__(self) -> None:
        self.forget()

    def forget(self) -> None:
        """Nothing was seen yet."""
        self._past: deque[Array] = deque(maxlen=MEMORY)
        self._ago: int | None = None
        self._looked, self._alike = False, ALIKE

    def see(self, points: Array) -> None:
        """What was really seen in this control period."""
        self._past.append(points)
        self._looked = False

    @property
    def ago(self) -> int | None:
        """Control periods since the points moved as they do now; None where nothing repeats."""
        if not self._looked:
            self._ago, self._looked = self._likeness(), True
            if self._ago is not None:
                self._gap = self._past[-1] - self._past[-1 - self._ago]
        return self._ago

    def like(self, alike: float) -> int | None:
        """`ago`, where they may differ by this share of the motion's own variance."""
        self._looked, self._alike = False, alike
        return self.ago

    def guess(self) -> Array | None:
        """(J, 3) m for a period in which nothing was seen; None where nothing repeats itself."""
        if self.ago is None:
            return None
        self._gap = FORGET * self._gap
        points = self._past[-self.ago] + self._gap
        self._past.append(points)
        return points

    def middle(self) -> Array:
        """(J, 3) m, about which the points moved in the stride that repeats itself."""
        assert self.ago is not None
        return np.mean([self._past[-1 - k] for k in range(self.ago)], axis=0)

    def _likeness(self) -> int | None:
        if len(self._past) < LIKENESS + PERIODS[0]:
            return None
        rows = np.array(self._past).reshape(len(self._past), -1)
        spread = float(np.mean((rows - rows.mean(axis=0)) ** 2))
        if 3.0 * spread < MOVES**2:
            return None
        now = rows[-LIKENESS:]
        last = min(PERIODS[1], len(rows) - LIKENESS)
        off = [
            float(np.mean((now - rows[-LIKENESS - ago : -ago]) ** 2))
            for ago in range(PERIODS[0], last + 1)
        ]
        best = int(np.argmin(off))
        return PERIODS[0] + best if off[best] < self._alike * spread else None
