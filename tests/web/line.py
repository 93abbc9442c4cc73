"""A line between a page and its server that can go dead, as a network's does, and come back."""

import contextlib
import socket
import threading
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any

CHUNK = 65536


@dataclass
class Line:
    """Forwards connections on `port` to a server's. While `alive` is not set nothing passes, and
    nothing is closed: what is sent meanwhile arrives later."""

    served: Any
    alive: threading.Event = field(default_factory=threading.Event)

    def __post_init__(self) -> None:
        self._sockets = [socket.create_server(("127.0.0.1", 0))]
        self._threads: list[threading.Thread] = []
        self.port = self._sockets[0].getsockname()[1]
        self.base, self.token = f"http://127.0.0.1:{self.port}", self.served.token
        self.alive.set()
        self._begin(self._accept)

    def _begin(self, work: Any, *args: Any) -> None:
        self._threads.append(threading.Thread(target=work, args=args, daemon=True))
        self._threads[-1].start()

    def _accept(self) -> None:
        with contextlib.suppress(OSError):
            while True:
                near, _ = self._sockets[0].accept()
                far = socket.create_connection(("127.0.0.1", self.served.port))
                self._sockets += [near, far]
                self._begin(self._pass, near, far)
                self._begin(self._pass, far, near)

    def _pass(self, near: socket.socket, far: socket.socket) -> None:
        with contextlib.suppress(OSError):
            while data := near.recv(CHUNK):
                self.alive.wait()
                far.sendall(data)
        _shut(far)

    def close(self) -> None:
        """Nothing is left open."""
        self.alive.set()
        for one in self._sockets:
            _shut(one)
        for thread in self._threads:
            thread.join(5.0)
        for one in self._sockets:
            one.close()


def _shut(one: socket.socket) -> None:
    with contextlib.suppress(OSError):
        one.shutdown(socket.SHUT_RDWR)


@contextlib.contextmanager
def line(served: Any) -> Iterator[Line]:
    """One to `served`, as long as it lasts; a page opens it as it would the server."""
    made = Line(served)
    try:
        yield made
    finally:
        made.close()
