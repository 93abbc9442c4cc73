"""`a1-studio serve`: loop, view and gateway in one process, one URL, a clean end."""

import contextlib
import errno
import logging
import os
import secrets
import signal
import socket
import sys
import tempfile
import threading
from collections.abc import Callable, Iterator
from pathlib import Path

import uvicorn

from studio.control.command import PuppeteerConfig
from studio.errors import StudioError
from studio.live.loop import LiveLoop
from studio.live.session import SessionConfig
from studio.options import ServeConfig
from studio.web.access import AccessConfig, page_url
from studio.web.desk import ControlDesk
from studio.web.feed import TickFeed
from studio.web.gateway import create_app
from studio.web.hub import Hub
from studio.web.inner import InnerViser
from studio.web.scene import StudioScene
from studio.web.view import View

log = logging.getLogger(__name__)
MAX_SOCKET_MESSAGE = 8 * 1024 * 1024
"""Bytes: frames of up to 1 MB must be answered, not closed on."""


def bind(host: str, port: int) -> socket.socket:
    """A listening socket, so that a taken port is known before anything starts."""
    family = socket.AF_INET6 if ":" in host else socket.AF_INET
    # The protocol by name: only then does asyncio send at once (TCP_NODELAY), or every answer
    # waits 40 ms for the client's delayed acknowledgement.
    listener = socket.socket(family, socket.SOCK_STREAM, socket.IPPROTO_TCP)
    try:
        listener.setsockopt(socket.SOL_SOCKET, socket.SO_REUSEADDR, 1)
        listener.bind((host, port))
        listener.listen(128)
    except (OSError, OverflowError) as error:
        listener.close()
        if isinstance(error, PermissionError | OverflowError):
            hint = "choose a port from 1024 to 65535 with --port"
        elif isinstance(error, socket.gaierror) or error.errno == errno.EADDRNOTAVAIL:
            hint = "give --host an address of this machine, such as 127.0.0.1"
        else:
            hint = "is another studio running? Stop it, or choose another with --port"
        why = getattr(error, "strerror", None) or str(error)
        raise StudioError(f"cannot listen on {host}:{port} ({why}): {hint}") from error
    return listener


def checked_token(token: str | None) -> str:
    """A token fit for a URL and a cookie; a new one if none was given."""
    if token is None:
        return secrets.token_urlsafe(24)
    if not 1 <= len(token) <= 200 or not all(
        c.isascii() and (c.isalnum() or c in "-_.~") for c in token
    ):
        raise StudioError("--token needs 1 to 200 letters, digits, or any of -_.~")
    if len(token) < 8:
        log.warning("the token is short enough to be guessed: leave --token out for a safe one")
    return token


def serve(config: ServeConfig, announce: Callable[[str], None] | None = None) -> None:
    """Run until SIGINT or SIGTERM. announce: given the URL once the page can be opened.

    StudioError for a taken port, an unknown source, or where no experts are trained.
    """
    with studio(config) as (server, listener, url):
        stop_on_signals(server)
        ready = threading.Thread(
            target=_announce, args=(server, url, announce or _say), daemon=True
        )
        ready.start()
        server.run(sockets=[listener])


@contextlib.contextmanager
def studio(config: ServeConfig) -> Iterator[tuple[uvicorn.Server, socket.socket, str]]:
    """Everything that serving needs, started; stopped in good order at the end."""
    with contextlib.ExitStack() as stack:
        listener = stack.enter_context(contextlib.closing(bind(config.host, config.port)))
        access = AccessConfig(
            token=checked_token(config.token),
            host=config.host,
            port=listener.getsockname()[1],
        )
        session = SessionConfig(
            source=config.source,
            sessions=Path(config.sessions),
            puppeteer=PuppeteerConfig(
                style=config.style, controller=config.controller, seed=config.seed
            ),
        )
        uploads = Path(stack.enter_context(tempfile.TemporaryDirectory(prefix="a1-studio-")))
        loop = LiveLoop(session)
        inner = InnerViser()
        stack.callback(inner.stop)
        view = View(StudioScene(inner.server), loop.ticks)
        stack.callback(view.stop)
        hub = Hub(
            loop=loop,
            access=access,
            desk=ControlDesk(loop.post, loop.beat, loop.silent),
            feed=TickFeed(loop.ticks),
            sessions=Path(config.sessions),
        )
        app = create_app(hub, inner, uploads)
        server = uvicorn.Server(
            uvicorn.Config(
                app,
                log_level="warning",
                access_log=False,
                ws="websockets-sansio",
                ws_max_size=MAX_SOCKET_MESSAGE,
                ws_per_message_deflate=False,
                ws_ping_interval=20.0,
                server_header=False,
                timeout_graceful_shutdown=2,
            )
        )
        logging.getLogger("uvicorn.error").addFilter(_is_news)
        loop.start()
        stack.callback(loop.stop)
        view.start()
        yield server, listener, page_url(access)


def _is_news(record: logging.LogRecord) -> bool:
    """Not a WebSocket refused with a status of our own, which uvicorn takes for an accident."""
    return "without completing handshake" not in record.getMessage()


def stop_on_signals(server: uvicorn.Server) -> None:
    """SIGINT and SIGTERM end the server, which ends everything else; a second one insists.

    uvicorn's own handlers raise the signal again at the end, which would make a clean exit look
    like a crash.
    """

    def handle(number: int, frame: object) -> None:
        if server.should_exit:
            os._exit(128 + number)
        server.should_exit = True

    server.capture_signals = contextlib.nullcontext  # type: ignore[method-assign, assignment]
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, handle)


def _announce(server: uvicorn.Server, url: str, announce: Callable[[str], None]) -> None:
    while not server.started and not server.should_exit:
        threading.Event().wait(0.02)
    if server.started:
        announce(url)


def _say(url: str) -> None:
    sys.stdout.write(f"{url}\n")
    sys.stdout.flush()
