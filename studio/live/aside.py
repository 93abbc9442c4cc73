"""Heavy work in a process of its own: Python runs one thread at a time."""

import multiprocessing
import os
import signal
import threading
from concurrent.futures import ProcessPoolExecutor

NICENESS = 5
"""The loop comes first: others take what is left."""


def one_process() -> ProcessPoolExecutor:
    """A process that gives way to others and ends with this one; begun when work is submitted."""
    return ProcessPoolExecutor(
        max_workers=1, mp_context=multiprocessing.get_context("spawn"), initializer=_settle
    )


def end(pool: ProcessPoolExecutor) -> None:
    """End the process, whatever it is at: who waits for it is told BrokenProcessPool."""
    for process in list((pool._processes or {}).values()):
        process.terminate()
    pool.shutdown(wait=False, cancel_futures=True)


def _settle() -> None:
    os.nice(NICENESS)
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # a Ctrl-C is for the server, which ends us
    parent = multiprocessing.parent_process()
    assert parent is not None

    def follow() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=follow, name="parent", daemon=True).start()
