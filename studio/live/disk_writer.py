"""Small disk work off the control loop's thread: done in order, one after another, never waited for
but at the end."""

import logging
import queue
import threading
from collections.abc import Callable

from studio.errors import StudioError

log = logging.getLogger(__name__)


class DiskWriter:
    """A thread that does what it is given, in order. `problem`: the last thing that failed."""

    def __init__(self) -> None:
        self._work: queue.SimpleQueue[Callable[[], object] | None] = queue.SimpleQueue()
        self._thread: threading.Thread | None = None
        self.problem = ""

    def do(self, work: Callable[[], object]) -> None:
        """Have something done soon; returns at once."""
        if self._thread is None:
            self._thread = threading.Thread(target=self._run, name="disk", daemon=True)
            self._thread.start()
        self._work.put(work)

    def close(self) -> None:
        """Wait until all is done; idempotent."""
        if self._thread is not None:
            self._work.put(None)
            self._thread.join(timeout=10.0)
            self._thread = None

    def _run(self) -> None:
        while (work := self._work.get()) is not None:
            try:
                work()
            except StudioError as error:
                self.problem = str(error)
                log.error("%s", error)
            except Exception as error:
                self.problem = f"disk work failed: {str(error) or type(error).__name__}"
                log.exception("disk work failed")
