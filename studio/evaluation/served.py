"""A studio's server in a process of its own, and WebSockets to one as its pages open them."""

import contextlib
import json
import socket
import subprocess
import sys
import time
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import version
from typing import TYPE_CHECKING, Any
from urllib.error import URLError
from urllib.request import Request, urlopen

from studio.errors import StudioError

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

TOKEN = "bench-token-0123456789"
PAGE_LIMIT = 60.0
"""s to wait for the server or the browser at most."""
VIEW = "/view"


@dataclass(frozen=True, kw_only=True)
class Served:
    """A server in its own process. printed, ready: s until its URL was printed and it answered."""

    pid: int
    port: int
    url: str
    printed: float
    ready: float

    def state(self) -> dict[str, Any]:
        """GET /api/state."""
        return json.loads(_get(self.port, "/api/state"))


@contextlib.contextmanager
def served(*options: str) -> Iterator[Served]:
    """`a1-studio serve` with some more options, ended afterwards.

    Raises StudioError when it does not start.
    """
    port = _free_port()
    began = time.perf_counter()
    server = subprocess.Popen(
        [sys.executable, "-m", "studio", "serve", "--port", str(port), "--token", TOKEN, *options],
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
    )
    try:
        assert server.stdout is not None
        url = server.stdout.readline().strip()
        if not url:
            raise StudioError(f"the server did not start: {_last_line(server)}")
        printed = time.perf_counter() - began
        _get(port, "/api/state")
        ready = time.perf_counter() - began
        yield Served(pid=server.pid, port=port, url=url, printed=printed, ready=ready)
    finally:
        end(server)


def page_socket(port: int, token: str, path: str, **options: Any) -> "ClientConnection":
    """A socket of a page on loopback; VIEW speaks viser's protocol. options: of `connect`."""
    from websockets.sync.client import connect

    return connect(
        f"ws://127.0.0.1:{port}{path}",
        additional_headers={"Authorization": f"Bearer {token}"},
        subprotocols=[f"viser-v{version('viser')}"] if path == VIEW else None,  # type: ignore[list-item]
        max_size=None,
        proxy=None,
        **options,
    )


def _get(port: int, path: str) -> str:
    request = Request(
        f"http://127.0.0.1:{port}{path}", headers={"Authorization": f"Bearer {TOKEN}"}
    )
    deadline = time.perf_counter() + PAGE_LIMIT
    while True:
        try:
            with urlopen(request, timeout=5.0) as answer:
                return answer.read().decode()
        except (URLError, ConnectionError, TimeoutError) as error:
            if time.perf_counter() > deadline:
                raise StudioError(f"the server did not answer: {error}") from error
            time.sleep(0.05)


def _free_port() -> int:
    with socket.socket() as s:
        s.bind(("127.0.0.1", 0))
        return int(s.getsockname()[1])


def end(process: "subprocess.Popen[Any]") -> None:
    """Terminate a process, or kill it where that is not enough; wait for it."""
    process.terminate()
    try:
        process.wait(10.0)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait(5.0)
    for pipe in (process.stdout, process.stderr):
        if pipe is not None:
            pipe.close()


def _last_line(server: "subprocess.Popen[str]") -> str:
    server.wait(5.0)
    lines = (server.stderr.read() if server.stderr else "").strip().splitlines()
    return lines[-1] if lines else "it said nothing"
