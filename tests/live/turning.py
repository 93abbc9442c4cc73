"""Loops that tests turn by hand, on a clock of their own."""

import threading
from typing import Any

from studio.live.loop import LiveLoop
from studio.takes.tick import Tick

DT = 1.0 / 30.0


def run(loop: LiveLoop, seconds: float) -> list[Tick]:
    """Ticks over `seconds` of the fake clock."""
    ticks = []
    for _ in range(round(seconds / DT)):
        loop.tick()
        tick = loop.ticks.get()
        assert tick is not None
        ticks.append(tick)
        loop.wait()
    return ticks


def ask(loop: LiveLoop, command: Any) -> Any:
    """The answer to a command submitted from another thread, as the gateway does.

    The loop turns only once it has the command: how long that takes to prepare must change nothing.
    """
    answers: list[Any] = []
    asker = threading.Thread(target=lambda: answers.append(loop.submit(command, timeout=120.0)))
    asker.start()
    while asker.is_alive():
        asker.join(0.01)  # what is prepared is prepared on its thread: leave it the machine
        if len(loop._requests) + len(loop._stops):
            run(loop, DT)
    return answers[0]
