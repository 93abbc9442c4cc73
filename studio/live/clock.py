"""Absolute deadlines at the control rate: late once does not mean late for ever."""

import threading
import time
from collections.abc import Callable
from typing import Protocol

from studio.robot.a1 import CONTROL_DT


class Clock(Protocol):
    """Where the loop gets its time from; tests give it one that they turn by hand."""

    def now(self) -> float:
        """Seconds, monotonic, arbitrary origin."""
        ...

    def sleep_until(self, t: float, wake: threading.Event | None = None) -> None:
        """Return at time `t` or soon after; at once when it has passed, or when `wake` is set."""
        ...


class WallClock:
    """The machine's monotonic clock."""

    def now(self) -> float:
        """Seconds since an arbitrary origin."""
        return time.perf_counter()

    def sleep_until(self, t: float, wake: threading.Event | None = None) -> None:
        """Sleep to `t`: coarsely first, then in small steps, as one long sleep wakes late."""
        while (left := t - time.perf_counter()) > 0.0:
            if left <= 0.002:
                time.sleep(min(left, 0.0002))
            elif wake is None:
                time.sleep(left - 0.001)
            elif wake.wait(left - 0.001):
                return


class Metronome:
    """Deadlines start, start + dt, ...; more than `slack` periods behind, it starts anew.

    Starting anew drops the missed periods: the robot must not rush to catch up.
    """

    def __init__(self, clock: Clock, dt: float = CONTROL_DT, slack: float = 3.0) -> None:
        self._clock, self._dt, self._slack = clock, dt, slack
        self.reset()

    def reset(self) -> None:
        """The next deadline is one period from now."""
        self._deadline = self._clock.now()
        self.late = 0
        self.error = 0.0
        self.dropped = 0.0

    def wait(
        self, wake: threading.Event | None = None, woken: Callable[[], object] = lambda: None
    ) -> float:
        """Sleep to the next deadline; returns by how much it was missed, s.

        Whenever `wake` is set meanwhile it is cleared, `woken` called, and the sleep goes on.
        Counts a period as late when its work ended after its deadline, and adds what is dropped,
        s, to `dropped`.
        """
        self._deadline += self._dt
        behind = self._clock.now() - self._deadline
        if behind > 0.0:
            self.late += 1
            if behind > self._slack * self._dt:
                self._deadline += behind
                self.dropped += behind
        self._clock.sleep_until(self._deadline, wake)
        while wake is not None and wake.is_set():
            wake.clear()
            woken()
            self._clock.sleep_until(self._deadline, wake)
        self.error = self._clock.now() - self._deadline
        return self.error
