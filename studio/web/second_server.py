"""A second server on the event loop of a first one, for connections that are to be few."""

import asyncio
import contextlib
import socket
from typing import Any

import uvicorn


class FewAtOnce(socket.socket):
    """A listening socket that drops connections beyond `most`, and `most_each` of one address.

    Before they are anybody: half-made TLS connections would take every descriptor of the studio.
    """

    most, most_each = 64, 24

    def __init__(self, listener: socket.socket) -> None:
        super().__init__(listener.family, listener.type, listener.proto, listener.detach())
        self._open: list[tuple[socket.socket, str]] = []

    def accept(self) -> tuple[socket.socket, Any]:
        """As a socket's, of those that there is room for."""
        while True:
            made, address = super().accept()
            self._open = [one for one in self._open if one[0].fileno() >= 0]
            of_this = sum(known == address[0] for _, known in self._open)
            if len(self._open) < self.most and of_this < self.most_each:
                self._open.append((made, address[0]))
                return made, address
            made.close()


class SecondServer(uvicorn.Server):
    """Serves an application whose lifespan is another server's; `state` is what that one made."""

    def __init__(self, config: uvicorn.Config, listener: socket.socket) -> None:
        """config: without a lifespan and signals of its own."""
        super().__init__(config)
        self.listener, self.state = listener, {}
        self.capture_signals = contextlib.nullcontext  # type: ignore[method-assign, assignment]

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """As uvicorn's, with the other server's state."""
        self.lifespan.state.update(self.state)
        await super().startup(sockets)


class FirstServer(uvicorn.Server):
    """A server beside which a second one runs on the same event loop, and ends before it."""

    def __init__(self, config: uvicorn.Config, second: SecondServer) -> None:
        super().__init__(config)
        self._second = second

    async def startup(self, sockets: list[socket.socket] | None = None) -> None:
        """Both."""
        await super().startup(sockets)
        self._second.state = self.lifespan.state
        self._running = asyncio.create_task(self._second.serve([self._second.listener]))

    async def shutdown(self, sockets: list[socket.socket] | None = None) -> None:
        """The second one first: what answers it is still there."""
        self._second.should_exit = True
        await self._running
        await super().shutdown(sockets)
