"""A clock for the loop that tests turn by hand."""

import threading


class FakeClock:
    """Time that passes only when told to: sleeping until `t` makes it `t`."""

    def __init__(self, start: float = 0.0) -> None:
        self.time = start

    def now(self) -> float:
        """The time set so far, s."""
        return self.time

    def sleep_until(self, t: float, wake: threading.Event | None = None) -> None:
        """Jump to `t`, never back."""
        self.time = max(self.time, t)

    def advance(self, seconds: float) -> None:
        """Let time pass, as a slow computation would."""
        self.time += seconds
