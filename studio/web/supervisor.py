"""Looks after the threads that all else needs: sees that one has ended, starts it again, and says
how things are."""

import logging
import threading
import time
from collections.abc import Callable, Mapping
from typing import Protocol

from studio.live.commands import Stop
from studio.live.faults import Faults
from studio.live.loop import LiveLoop

log = logging.getLogger(__name__)
PERIOD = 0.25
SILENT_S = 1.0
"""s without a tick after which the loop hangs."""
REMEMBERED_S = 30.0
"""s for which a thread that was started again is told of."""


class Supervised(Protocol):
    """A thread and what goes wrong in it."""

    faults: Faults

    @property
    def alive(self) -> bool:
        """It runs."""
        ...

    def start(self) -> None:
        """Run; again after it has ended."""
        ...


class Supervisor:
    """Watches the control loop and `others` (by what to call them), each started already."""

    def __init__(
        self,
        loop: LiveLoop,
        others: Mapping[str, Supervised],
        clock: Callable[[], float] = time.monotonic,
    ) -> None:
        self._loop, self._clock = loop, clock
        self._supervised: dict[str, Supervised] = {"control loop": loop, **others}
        self._restarts: dict[str, tuple[int, float]] = {}
        self._version, self._ticked = -1, clock()
        self._stop = threading.Event()
        self._thread = threading.Thread(target=self._run, name="supervisor", daemon=True)

    def start(self) -> None:
        """Watch from now on."""
        self._thread.start()

    def stop(self) -> None:
        """Watch no more: before what is watched is ended."""
        self._stop.set()
        if self._thread.is_alive():
            self._thread.join(timeout=2.0)

    def check(self) -> None:
        """Start again what has ended. The robot of a loop that ended is stopped."""
        now = self._clock()
        if self._loop.ticks.version != self._version:
            self._version, self._ticked = self._loop.ticks.version, now
        for name, thread in self._supervised.items():
            if not thread.alive:
                log.error("the %s has ended: it is started again", name)
                self._restarts[name] = (self._restarts.get(name, (0, 0.0))[0] + 1, now)
                if thread is self._loop:
                    self._loop.post(Stop(by="the studio, whose control loop had ended"))
                thread.start()

    def troubles(self) -> tuple[list[str], list[str]]:
        """(why the robot cannot be driven, what else is not as it should be); both empty: well."""
        now, grave, minor = self._clock(), [], []
        if self._loop.ticks.version == 0:
            grave.append("starting")
        elif now - self._ticked > SILENT_S:
            grave.append(f"the control loop has been silent for {now - self._ticked:.0f} s")
        if self._loop.faults.recent:
            grave.append("control periods fail; the robot is stopped")
        for name, thread in self._supervised.items():
            if thread is not self._loop and thread.faults.recent:
                minor.append(f"the {name} fails")
            count, at = self._restarts.get(name, (0, 0.0))
            if count and now - at < REMEMBERED_S:
                minor.append(f"the {name} ended and was started again ({count} times)")
        return grave, minor

    def _run(self) -> None:
        while not self._stop.wait(PERIOD):
            try:
                self.check()
            except Exception:
                log.exception("the supervisor could not check")
