"""Ticks for sockets: encoded once, however many listen; who reads slowly misses some."""

import asyncio
import threading
from collections.abc import AsyncIterator

from studio.live.mailbox import Latest
from studio.takes.tick import Tick
from studio.web.encode import tick_json


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

    def start(self, loop: asyncio.AbstractEventLoop) -> None:
        """Begin; frames are handed over on `loop`."""
        self._thread = threading.Thread(target=self._run, args=(loop,), name="feed", daemon=True)
        self._thread.start()

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

    def _run(self, loop: asyncio.AbstractEventLoop) -> None:
        version = 0
        while not self._stop.is_set():
            new, tick = self._ticks.wait(version, timeout=0.25)
            if tick is None or new == version:
                continue
            version = new
            if self._subscribers:
                try:
                    loop.call_soon_threadsafe(self._offer, tick_json(tick))
                except RuntimeError:
                    return  # the event loop has closed

    def _offer(self, frame: bytes) -> None:
        for subscriber in tuple(self._subscribers):
            subscriber.offer(frame)
