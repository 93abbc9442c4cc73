"""What one client may take of the server: turns, time to say what it wants, connections.

uvicorn hands over whatever a socket has sent, at once; a client that sends without pause is then
heard alone, and one that says nothing holds its connection for ever. So a WebSocket is read a
little at a time and at a bounded rate, a request has to be told in time, and there are only so many
connections, of which those that have asked for nothing go first.
"""

import asyncio
import math
import resource
import time
from collections.abc import Callable
from typing import Any

import h11
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol
from websockets.frames import Frame

from studio.web.stop_order import STOPS_KNOWN, StopOrder

CHUNK = 4096
"""Bytes read of a WebSocket at once: some 700 of the smallest frames, 8 ms of work."""
RATE, BURST = 200.0, 100.0
"""Frames a second of one WebSocket, and how many at once; people send 30, cameras up to 60."""
FRAME_BYTES = 16_384
"""A frame counts as one more for each of these."""
MAX_FRAGMENTS = 1024
REQUESTS, REQUESTS_AT_ONCE = 100.0, 100.0
"""Requests a second, each some 2 ms of work, and how many at once."""
PATIENCE_S = 2.0
HEAD_S = 10.0
"""s to send a request's line and headers."""
BODY_S = 30.0
"""s of silence in the midst of a request's body."""
CHECK_S = 2.0
MOST = 384
"""Connections, two thirds of which may be WebSockets. A view's costs three descriptors."""
_DESCRIPTORS = 4096


class TokenBucket:
    """A token bucket: `rate` a second, `burst` at once."""

    def __init__(
        self, rate: float, burst: float, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.rate, self.burst, self._clock = rate, burst, clock
        self._left, self._at = burst, clock()

    def spend(self, cost: float, patience: float = math.inf) -> float:
        """Take `cost`, though it be more than is left; s until it is made up for, 0 if it was not.

        Infinite, and nothing is taken, where that is longer than `patience` s.
        """
        now = self._clock()
        self._left = min(self.burst, self._left + self.rate * (now - self._at))
        self._at = now
        wait = max(0.0, (cost - self._left) / self.rate)
        if wait > patience:
            return math.inf
        self._left -= cost
        return wait


class RequestLimiter:
    """Requests at a bounded rate: of everybody together, for they all share one event loop."""

    def __init__(self, rate: float = REQUESTS, burst: float = REQUESTS_AT_ONCE) -> None:
        self._budget = TokenBucket(rate, burst)

    async def take(self) -> bool:
        """Wait for a turn; False where too many wait already."""
        wait = self._budget.spend(1.0, PATIENCE_S)
        if wait == math.inf:
            return False
        if wait > 0.0:
            await asyncio.sleep(wait)
        return True


class LimitedWebSocket(WebSocketsSansIOProtocol):
    """A WebSocket that takes turns with everything else on the event loop.

    Beyond its rate it is not read: TCP then holds up the sender, and nobody else.
    """

    def __init__(self, *args: Any, **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self._budget = TokenBucket(RATE, BURST, self.loop.time)
        self._cost, self._held = 0.0, False

    def connection_made(self, transport: Any) -> None:
        """As uvicorn's; from now on a chunk a turn."""
        super().connection_made(transport)
        # What asyncio reads at once, under TLS and without; neither has a public name for it.
        getattr(transport, "_ssl_protocol", transport).max_size = CHUNK

    def data_received(self, data: bytes) -> None:
        """As uvicorn's, counted."""
        self._cost = len(data) / FRAME_BYTES
        super().data_received(data)

    def handle_events(self) -> None:
        """As uvicorn's, counted: pings and pieces of messages too, which no application sees."""
        wait = self._budget.spend(self._cost + len(self.conn.events))
        super().handle_events()
        if wait > 0.0 and not self._held and not self.transport.is_closing():
            self._held = True
            self.transport.pause_reading()
            self.loop.call_later(wait, self._release)

    def handle_cont(self, event: Frame) -> None:
        """A piece of a message; a message has only so many, for empty ones would never end."""
        if len(self.frames) >= MAX_FRAGMENTS:
            self.transport.close()
            return
        super().handle_cont(event)

    async def receive(self) -> Any:
        """The next message, after everybody else's turn."""
        await asyncio.sleep(0)
        message = await self.queue.get()
        if self.read_paused and self.queue.empty():
            self.read_paused = False
            self._resume()
        return message

    def _release(self) -> None:
        self._held = False
        self._resume()

    def _resume(self) -> None:
        if not self._held and not self.read_paused and not self.transport.is_closing():
            self.transport.resume_reading()


class LimitedHttp(H11Protocol):
    """A request that is told in time, on one of a bounded number of connections, and that says
    which stops were known when it was received."""

    most = MOST
    _received: int | None = None

    def connection_made(self, transport: asyncio.Transport) -> None:  # type: ignore[override]
        """As uvicorn's; where there are too many, one that asks for nothing makes room."""
        super().connection_made(transport)
        self._order: StopOrder | None = self.app_state.get("stop_order")
        self._descriptor = transport.get_extra_info("socket").fileno()
        if self._order is not None:
            self._order.add(self._descriptor, self)
        self._heard = self._since = self.loop.time()
        self._timer = self.loop.call_later(CHECK_S, self._check)
        if len(self.connections) > self.most:
            waiting = [c for c in self.connections if isinstance(c, LimitedHttp) and c.asks_nothing]
            # Those first that never asked for anything, and of them the oldest.
            min(waiting, key=lambda c: (c.cycle is not None, c._since), default=self)._drop()

    def connection_lost(self, exc: Exception | None) -> None:
        """As uvicorn's."""
        self._timer.cancel()
        self._no_door()
        super().connection_lost(exc)

    def shutdown(self) -> None:
        """As uvicorn's; who is in the midst of a request's body is not waited for."""
        if self._telling:
            self.transport.abort()  # at once: under TLS a close waits for the other side's
        else:
            super().shutdown()

    def data_received(self, data: bytes) -> None:
        """As uvicorn's, noted."""
        self._heard = self.loop.time()
        begins = self.conn.their_state is h11.IDLE and not self.conn.trailing_data[0]
        if self._order is not None and begins:
            known = self._order.known() if self._received is None else self._received
            self.app_state = {**self.app_state, STOPS_KNOWN: known}
        self._received = None
        super().data_received(data)

    def received_before(self, stops: int) -> None:
        """See `stop_order.Door`."""
        self._received = stops if self._received is None else min(stops, self._received)

    def on_response_complete(self) -> None:
        """As uvicorn's; the next request's time begins."""
        self._since = self.loop.time()
        super().on_response_complete()

    def handle_websocket_upgrade(self, event: h11.Request) -> None:
        """As uvicorn's, as long as WebSockets leave room for requests."""
        self._timer.cancel()
        self._no_door()
        if sum(isinstance(c, LimitedWebSocket) for c in self.connections) < 2 * self.most // 3:
            super().handle_websocket_upgrade(event)
            return
        self.transport.write(
            b"HTTP/1.1 503 Service Unavailable\r\nconnection: close\r\ncontent-length: 0\r\n\r\n"
        )
        self._drop()

    @property
    def asks_nothing(self) -> bool:
        """No request has been told whole since the last one was answered."""
        return self.cycle is None or self.cycle.response_complete

    @property
    def _telling(self) -> bool:
        return not self.asks_nothing and self.conn.their_state is h11.SEND_BODY

    def _check(self) -> None:
        now = self.loop.time()
        if self.asks_nothing:
            late = now - self._since > HEAD_S
        else:
            late = self._telling and not self.flow.read_paused and now - self._heard > BODY_S
        if late:
            self._drop()
        else:
            self._timer = self.loop.call_later(CHECK_S, self._check)

    def _no_door(self) -> None:
        if self._order is not None:
            self._order.remove(self._descriptor)

    def _drop(self) -> None:
        self.connections.discard(self)
        self.transport.close()


def room_for_connections() -> int:
    """How many connections the system's limit on descriptors allows, raised where it may be."""
    soft, hard = resource.getrlimit(resource.RLIMIT_NOFILE)
    unlimited = resource.RLIM_INFINITY
    wanted = _DESCRIPTORS if hard == unlimited else min(hard, _DESCRIPTORS)
    if soft != unlimited and soft < wanted:
        resource.setrlimit(resource.RLIMIT_NOFILE, (wanted, hard))
    # One descriptor each, two more for the views among them, some for files.
    return max(16, min(MOST, 3 * (max(wanted, soft) - 128) // 7))
