"""The view's own thread: at most 30 times a second the newest tick becomes the newest picture."""

import logging
import threading
import time
from typing import Protocol

from studio.live.faults import Faults
from studio.live.mailbox import Latest
from studio.takes.tick import Tick

log = logging.getLogger(__name__)
VIEW_DT = 1.0 / 30.0


class Shows(Protocol):
    """What draws a tick."""

    def update(self, tick: Tick, dt: float) -> None:
        """Show `tick`; dt: seconds since the one before."""
        ...


class View:
    """Reads the mailbox, draws, and never holds up the loop: it only ever sees the latest."""

    def __init__(self, scene: Shows, ticks: Latest[Tick]) -> None:
        self._scene, self._ticks = scene, ticks
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self.faults = Faults(log)
        self.frames = 0

    def start(self) -> None:
        """Begin to draw."""
        self._thread = threading.Thread(target=self._run, name="view", daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """The thread runs."""
        return self._thread is not None and self._thread.is_alive()

    def stop(self) -> None:
        """Draw no more; returns once the thread has ended."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)

    def _run(self) -> None:
        version, shown = 0, time.perf_counter() - VIEW_DT
        while not self._stop.is_set():
            new, tick = self._ticks.wait(version, timeout=0.25)
            if tick is None or new == version:
                continue
            version, now = new, time.perf_counter()
            try:
                self._scene.update(tick, now - shown)
            except Exception as error:
                # One picture lost; the loop and the other pages must not notice.
                self.faults.tell("the view could not draw a tick", error)
            shown = now
            self.frames += 1
            # A tick every 33 ms arrives by itself; this only bounds a faster feed.
            self._stop.wait(max(0.0, 0.8 * VIEW_DT - (time.perf_counter() - now)))
