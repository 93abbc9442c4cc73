"""In which order stops and releases count: a stop that was answered holds against every release
that had been received by then.

A stop is *under way* from when it is received until its answer leaves. What would release the robot
is stamped when it is received with the stops that count as known, none of those under way among
them; the loop refuses it where there were more (`LiveLoop.submit`). Only what comes after a stop's
answer has left can undo that stop, whichever connection either takes.
"""

import select
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import Protocol

from starlette.types import ASGIApp, Message, Receive, Scope, Send

STOP_PATH = "/api/stop"
STOPS_KNOWN = "stops_known"
"""In a request's state: what was known when it was received."""


class Door(Protocol):
    """A connection that may have received what nobody has read yet."""

    def received_before(self, stops: int) -> None:
        """What is read next had been received when only `stops` stops were known."""
        ...


class StopOrder:
    """Stops under way, and the connections by which releases come. The event loop's thread only.

    answered: how many stops the control loop has answered, falls and faults among them.
    """

    def __init__(self, answered: Callable[[], int]) -> None:
        self._answered = answered
        self._under_way: list[int] = []  # what was known when each was received
        self._doors: dict[int, Door] = {}
        self._poll = select.poll()

    def known(self) -> int:
        """How many stops whoever sends something now may know of."""
        return min((*self._under_way, self._answered()))

    @contextmanager
    def under_way(self) -> Iterator[Callable[[], None]]:
        """A stop was received. Call what this gives just before the stop's answer is written."""
        floor, left = self.known(), False
        self._under_way.append(floor)

        def leaves() -> None:
            nonlocal left
            if not left:
                left = True
                self._stamp_unread()
                self._under_way.remove(floor)

        try:
            yield leaves
        finally:
            leaves()  # whoever asked has gone: nobody will be answered

    def add(self, descriptor: int, door: Door) -> None:
        """A connection was made."""
        self._doors[descriptor] = door
        self._poll.register(descriptor, select.POLLIN)

    def remove(self, descriptor: int) -> None:
        """It is lost, or carries no requests any more."""
        if self._doors.pop(descriptor, None) is not None:
            self._poll.unregister(descriptor)

    def _stamp_unread(self) -> None:
        """What lies unread in the system's buffers has been received: before this answer leaves."""
        known = self.known()
        for descriptor, _ in self._poll.poll(0):
            self._doors[descriptor].received_before(known)


class StopAnswers:
    """ASGI: knows each POST /api/stop under way until its answer is written."""

    def __init__(self, app: ASGIApp, order: StopOrder) -> None:
        self.app, self.order = app, order

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Pass on; the answer's last part ends it."""
        if scope["type"] != "http" or scope["path"] != STOP_PATH or scope["method"] != "POST":
            await self.app(scope, receive, send)
            return
        with self.order.under_way() as leaves:

            async def answer(message: Message) -> None:
                if message["type"] == "http.response.body" and not message.get("more_body"):
                    leaves()
                await send(message)

            await self.app(scope, receive, answer)
