"""Heavy work on files in a process of its own: Python runs one thread at a time, and eight imports
at once would leave the control loop and every answer a ninth of it."""

import asyncio
import logging
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from typing import ParamSpec, TypeVar

from studio.errors import StudioError
from studio.live.aside import end, one_process

log = logging.getLogger(__name__)
P = ParamSpec("P")
T = TypeVar("T")


class WorkerProcess:
    """One process, begun when it is first needed; work waits its turn. The event loop's thread."""

    def __init__(self) -> None:
        self._pool: ProcessPoolExecutor | None = None

    async def run(self, work: Callable[P, T], *args: P.args, **kwargs: P.kwargs) -> T:
        """`work`, a function of a module, run there; raises what it raises.

        StudioError where the process was killed in the midst of it, or closed before it began.
        """
        if self._pool is None:
            self._pool = one_process()
        pool = self._pool
        waits = pool.submit(work, *args, **kwargs)
        try:
            return await asyncio.wrap_future(waits)
        except asyncio.CancelledError as error:
            task = asyncio.current_task()
            if self._pool is pool or (task is not None and task.cancelling()):
                raise
            # Not this task was cancelled but its work: the pool ended before it had begun.
            raise StudioError("this work was ended before it began") from error
        except BrokenProcessPool as error:
            if self._pool is pool:
                self._pool = None  # the next one begins another
            log.error("the process that works on files was ended: %s", error)
            raise StudioError(
                "the system ended this work, perhaps for want of memory: try less at once"
            ) from error

    def close(self) -> None:
        """End the process, whatever it is at."""
        pool, self._pool = self._pool, None
        if pool is not None:
            end(pool)
