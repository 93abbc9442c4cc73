"""Rivals, fitted to synthetic people while the robot goes on."""

import logging
import threading
from concurrent.futures import CancelledError, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool

from studio.errors import StudioError
from studio.live.aside import end, one_process
from studio.reference.intent import StateName
from studio.retarget.store import Experts
from studio.training.rivals import SECONDS, open_willing

log = logging.getLogger(__name__)
Fitted = tuple[Experts, dict[StateName, str]]
"""The experts, and the states that the rival refused, with why."""


class Fitting:
    """Fits one rival at a time, and keeps those that it has fitted. Any thread."""

    def __init__(self) -> None:
        self._lock = threading.Lock()
        self._pool: ProcessPoolExecutor | None = None
        self._kept: dict[tuple[str, str], Fitted] = {}
        self.name: str | None = None
        """Whom, now."""
        self.seconds = SECONDS
        """Of synthetic people a state."""

    def fitted(self, name: str, style: str) -> Fitted:
        """A rival's experts for a style; waits for them, unless it has them. StudioError where it
        refuses every state, and where another was asked for meanwhile."""
        if (kept := self._kept.get((name, style))) is not None:
            return kept
        with self._lock:
            self._end()
            pool = self._pool = one_process()
            self.name = name
            work = pool.submit(open_willing, name, style, self.seconds)
        try:
            found = self._kept[name, style] = work.result()
            return found
        except (BrokenProcessPool, CancelledError) as error:
            if self._pool is not pool:
                raise StudioError(f"{name} was not fitted: it was ended before") from error
            log.error("the process that fits %s was ended: %s", name, error)
            raise StudioError(f"the system ended the fitting of {name}: try again") from error
        finally:
            with self._lock:
                if self._pool is pool:
                    self._end()

    def cancel(self) -> None:
        """Whoever waits for a rival is refused: another mapper was chosen, or the studio ends."""
        with self._lock:
            self._end()

    def _end(self) -> None:
        pool, self._pool, self.name = self._pool, None, None
        if pool is not None:
            end(pool)
