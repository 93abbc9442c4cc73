"""The viser server inside: on loopback, behind a secret that only our relay knows.

viser trusts every client (it checks no Host, Origin or token, runs share tunnels on request and
lets a client change any control), so nobody but `relay.py` may connect to it, and of what a
browser sends only the camera's position is let through. Three private things of viser 1.1 are
used here; tests/web/test_web_viser_canary.py fails if one of them moves.
"""

import hmac
import math
import os
import secrets
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import msgspec
import rich
import viser
import websockets.asyncio.server
from viser import _messages
from websockets.datastructures import Headers
from websockets.http11 import Request, Response

SECRET_HEADER = "X-Studio-Inner"
MAX_CLIENT_MESSAGE = 16 * 1024
_SERVE_LOCK = threading.Lock()


class GuardedViser:
    """A ViserServer on 127.0.0.1 with a port of the system's choice, closed to strangers."""

    def __init__(self) -> None:
        self.secret = secrets.token_urlsafe(32)
        os.environ.pop("_VISER_PORT_OVERRIDE", None)  # would move us off the system's port
        with _quiet(), self._guarded_serve():
            self.server = viser.ViserServer(host="127.0.0.1", port=0, verbose=False)
        # A page must not open a tunnel to the outside.
        for kind in (_messages.ShareUrlRequest, _messages.ShareUrlDisconnect):
            self.server._websock_server._incoming_handlers.pop(kind)
        self.server.gui.configure_theme(show_logo=False, show_share_button=False)

    @property
    def port(self) -> int:
        """The loopback port viser listens on."""
        return self.server.get_port()

    def request_allowed(self, headers: Headers) -> bool:
        """Only our relay: its secret, our Host, and no Origin (every browser sends one)."""
        return (
            hmac.compare_digest(_bytes(headers.get(SECRET_HEADER, "")), _bytes(self.secret))
            and headers.get_all("Host") == [f"127.0.0.1:{self.port}"]
            and "Origin" not in headers
        )

    @contextmanager
    def _guarded_serve(self) -> Iterator[None]:
        """While viser starts, put our check before its own handler of each request."""
        module = websockets.asyncio.server
        original = module.serve

        def serve(*args: Any, process_request: Any = None, **kwargs: Any) -> Any:
            def guarded(connection: Any, request: Request) -> Response | None:
                if not self.request_allowed(request.headers):
                    return Response(403, "Forbidden", Headers())
                return process_request(connection, request) if process_request else None

            return original(*args, process_request=guarded, **kwargs)

        with _SERVE_LOCK:
            module.serve = serve  # type: ignore[assignment]
            try:
                yield
            finally:
                module.serve = original

    def stop(self) -> None:
        """Close every connection and the port."""
        with _quiet():
            self.server.stop()


def _bytes(text: str) -> bytes:
    """Of a header, whatever was sent: digests of text are compared in ASCII only."""
    return text.encode("utf-8", "surrogatepass")


def client_message_allowed(raw: bytes) -> bool:
    """Whether a browser's message may reach viser: a finite camera, and nothing else."""
    if len(raw) > MAX_CLIENT_MESSAGE:
        return False
    try:
        message = msgspec.msgpack.decode(raw)
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError):
        return False
    if not isinstance(message, dict) or message.get("type") != "ViewerCameraMessage":
        return False
    shapes = {"wxyz": 4, "position": 3, "look_at": 3, "up_direction": 3}
    scalars = {"fov", "near", "far", "image_height", "image_width"}
    if set(message) != {"type", *shapes, *scalars}:
        return False
    return all(
        isinstance(message[key], list)
        and len(message[key]) == n
        and all(map(_finite, message[key]))
        for key, n in shapes.items()
    ) and all(_finite(message[key]) for key in scalars)


def client_html() -> str:
    """viser's browser client: one self-contained HTML file."""
    return (Path(viser.__file__).parent / "client" / "build" / "index.html").read_text("utf-8")


def _finite(value: object) -> bool:
    return type(value) in (int, float) and math.isfinite(value)  # type: ignore[arg-type]


@contextmanager
def _quiet() -> Iterator[None]:
    """viser announces its inner address on standard output; ours is the only one to show."""
    console = rich.get_console()
    before, console.quiet = console.quiet, True
    try:
        yield
    finally:
        console.quiet = before
