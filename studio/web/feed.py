"""Ticks for sockets: encoded once, however many listen; who reads slowly misses some."""

import asyncio
import logging
import threading
from collections.abc import AsyncIterator

from studio.live.faults import Faults
from studio.live.mailbox import Latest
from studio.takes.as_json import tick_json
from studio.takes.tick import Tick

log = logging.getLogger(__name__)


class Subscriber:
    """One listener's newest frame."""

    def __init__(self) -> None:
        self._frame: bytes | None = None
        self._ready = asyncio.Event()
        self.dropped = 0

    def offer(self, frame: bytes) -> None:
        """Replace the frame that was not taken yet (event loop's thread)."""
        self.dropped += self._frame is not None
        self._frame = frame
        self._ready.set()

    async def __aiter__(self) -> AsyncIterator[bytes]:
        """The newest frame, again and again."""
        while True:
            await self._ready.wait()
            self._ready.clear()
            frame, self._frame = self._frame, None
            if frame is not None:
                yield frame


class TickFeed:
    """A thread that waits for ticks and hands them, as JSON, to the event loop."""

    def __init__(self, ticks: Latest[Tick]) -> None:
        self._ticks = ticks
        self._subscribers: set[Subscriber] = set()
        self._stop = threading.Event()
        self._thread: threading.Thread | None = None
        self._loop: asyncio.AbstractEventLoop | None = None
        self.faults = Faults(log)

    def begin(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begin; frames are handed over on `loop`."""
        self._loop = loop
        self.start()

    def start(self) -> None:
        """Go on, on the event loop that `begin` was given."""
        self._thread = threading.Thread(target=self._run, name="feed", daemon=True)
        self._thread.start()

    @property
    def alive(self) -> bool:
        """The thread runs, or was never begun."""
        return self._thread is None or self._thread.is_alive() or self._stop.is_set()

    def stop(self) -> None:
        """End the thread."""
        self._stop.set()
        if self._thread is not None:
            self._thread.join(timeout=2.0)

    def subscribe(self) -> Subscriber:
        """Start to listen (event loop's thread)."""
        subscriber = Subscriber()
        self._subscribers.add(subscriber)
        return subscriber

    def unsubscribe(self, subscriber: Subscriber) -> None:
        """Listen no more."""
        self._subscribers.discard(subscriber)

    def _run(self) -> None:
        loop, version = self._loop, 0
        assert loop is not None
        while not self._stop.is_set():
            new, tick = self._ticks.wait(version, timeout=0.25)
            if tick is None or new == version:
                continue
            version = new
            if self._subscribers:
                try:
                    frame = tick_json(tick)
                except Exception as error:
                    # One tick lost; the next may be as it should.
                    self.faults.tell("a tick could not be encoded", error)
                    continue
                try:
                    loop.call_soon_threadsafe(self._offer, frame)
                except RuntimeError:
                    return  # the event loop has closed

    def _offer(self, frame: bytes) -> None:
        for subscriber in tuple(self._subscribers):
            subscriber.offer(frame)
