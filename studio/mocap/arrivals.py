"""How frames of a live source come: how often, how evenly, how late, and how long they wait."""

from collections import deque
from dataclasses import dataclass

import numpy as np

from studio.statistics import percentiles

OVER_S = 2.0
"""s looked back over."""


@dataclass(frozen=True, kw_only=True)
class Arrivals:
    """Of the last seconds. rate_hz: frames a second. jitter_ms: mean difference between the ways of
    two frames after each other (the sender's clock to ours; RFC 3550's, not smoothed). late_ms: by
    how much a frame's way is longer than the quickest one's; what the quickest took is not known,
    since the clocks are two. wait_ms: from a frame's arrival to the control period that reads it.
    """

    rate_hz: float
    jitter_ms: float
    late_ms: dict[str, float]
    wait_ms: dict[str, float]


class ArrivalLog:
    """Remembers the last seconds. Times are s by one clock, `sent` by the sender's own."""

    def __init__(self) -> None:
        self._came: deque[tuple[float, float]] = deque()
        self._waits: deque[tuple[float, float]] = deque()

    def came(self, now: float, sent: float) -> None:
        """A frame arrived that was good."""
        self._came.append((now, sent))
        _forget(self._came, now)

    def read(self, now: float, arrived: float) -> None:
        """The control loop reads a frame that arrived then."""
        self._waits.append((now, now - arrived))
        _forget(self._waits, now)

    def anew(self) -> None:
        """Another sender, whose clock is its own."""
        self._came.clear()
        self._waits.clear()

    def summary(self, now: float) -> Arrivals | None:
        """None where too few frames came of late to tell."""
        _forget(self._came, now)
        _forget(self._waits, now)
        if len(self._came) < 3 or not self._waits:
            return None
        at, sent = np.array(self._came).T
        way = 1e3 * (at - sent)
        return Arrivals(
            rate_hz=round((len(at) - 1) / max(float(at[-1] - at[0]), 1e-3), 1),
            jitter_ms=round(float(np.mean(np.abs(np.diff(way)))), 2),
            late_ms=_rounded(way - way.min()),
            wait_ms=_rounded([1e3 * wait for _, wait in self._waits]),
        )


def _forget(kept: deque[tuple[float, float]], now: float) -> None:
    while kept and now - kept[0][0] > OVER_S:
        kept.popleft()


def _rounded(ms: "np.ndarray | list[float]") -> dict[str, float]:
    return {name: round(value, 2) for name, value in percentiles(ms).items()}
