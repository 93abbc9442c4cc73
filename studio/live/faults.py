"""Faults that come again thirty times a second: told once with everything known, then counted."""

import logging
import time
from collections import Counter
from collections.abc import Callable

RECENT_S = 2.0
AGAIN_S = 60.0
"""Seconds between two lines on the same fault."""


class Faults:
    """What went wrong in one thread, for its log and for whoever asks how it is. That thread tells;
    `recent` and `count` may be read by any."""

    def __init__(self, log: logging.Logger, clock: Callable[[], float] = time.monotonic) -> None:
        self._log, self._clock = log, clock
        self._seen: Counter[tuple] = Counter()
        self._logged_at: dict[tuple, float] = {}
        self._last = float("-inf")
        self.count = 0

    def tell(self, what: str, error: BaseException) -> None:
        """`error` came up: in full the first time, a line with their number once a minute then.

        The same fault is one of the same kind that was raised at the same place.
        """
        now = self._clock()
        self.count, self._last = self.count + 1, now
        at = error.__traceback__
        while at is not None and at.tb_next is not None:
            at = at.tb_next
        place = (at.tb_frame.f_code.co_filename, at.tb_lineno) if at is not None else ()
        fault = (what, type(error), place)
        self._seen[fault] += 1
        if fault not in self._logged_at:
            self._log.error("%s", what, exc_info=error)
        elif now - self._logged_at[fault] >= AGAIN_S:
            self._log.error("%s: %s (%d times so far)", what, error, self._seen[fault])
        else:
            return
        self._logged_at[fault] = now

    @property
    def recent(self) -> bool:
        """Something went wrong within the last two seconds."""
        return self._clock() - self._last < RECENT_S
