"""`a1-studio serve`: loop, view and gateway in one process, one URL, a clean end."""

import contextlib
import errno
import logging
import os
import signal
import socket
import ssl
import sys
import threading
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import uvicorn
from starlette.types import ASGIApp

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.files import scratch_folder, sweep, sweep_writes
from studio.live.loop import LiveLoop
from studio.live.mappers import FOLDER as MAPPERS
from studio.live.runtime import RuntimeConfig
from studio.options import ServeConfig
from studio.takes.export import adding
from studio.web.access import EVERYWHERE, LOOPBACK_HOSTS, AccessConfig, checked_names, page_url
from studio.web.client_limits import LimitedHttp, LimitedWebSocket, room_for_connections
from studio.web.feed import TickFeed
from studio.web.gateway import create_app
from studio.web.guarded_viser import GuardedViser
from studio.web.hub import Hub
from studio.web.page_control import PageControl
from studio.web.scene import StudioScene
from studio.web.supervisor import Supervisor
from studio.web.tokens import checked_token, kept_token
from studio.web.view import View

log = logging.getLogger(__name__)
MAX_SOCKET_MESSAGE = 2 * 1024 * 1024
"""Bytes: frames of up to 1 MB must be answered, not closed on."""
NO_NEWS = (
    "without completing handshake",
    "Invalid HTTP request received",
    "Unsupported upgrade request",
    "No supported WebSocket library",
    "Invalid UTF-8 sequence received",
)
SCRATCH = "a1-studio-"
"""Beginning of a studio's temporary folder."""


def bind(host: str, port: int) -> socket.socket:
    """A listening socket, so that a taken port is known before anything starts.

    Raises StudioError for a port or an address that cannot be had.
    """
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
    names, tls = checked_names(config.allow_host), checked_tls(config)
    sessions = Path(config.sessions)
    sweep(SCRATCH)
    sweep(adding.SCRATCH, sessions)
    sweep_writes(sessions / MAPPERS)
    with contextlib.ExitStack() as stack:
        listener = stack.enter_context(contextlib.closing(bind(config.host, config.port)))
        access = AccessConfig(
            token=kept_token(sessions) if config.token is None else checked_token(config.token),
            host=config.host,
            port=listener.getsockname()[1],
            names=names,
            secure=bool(tls),
        )
        runtime = RuntimeConfig(
            source=config.source,
            sessions=sessions,
            puppeteer=PuppeteerConfig(
                style=config.style,
                controller=config.controller,
                seed=config.seed,
                scene=config.scene,
            ),
        )
        scratch = stack.enter_context(scratch_folder(SCRATCH))
        loop = LiveLoop(runtime)
        inner = GuardedViser()
        stack.callback(inner.stop)
        scene = StudioScene(
            inner.server,
            lambda: loop.runtime.puppeteer.config.mirror,
            lambda: loop.runtime.props,
        )
        view, feed = View(scene, loop.ticks), TickFeed(loop.ticks)
        stack.callback(view.stop)
        supervisor = Supervisor(loop, {"view": view, "feed": feed})
        hub = Hub(
            loop=loop,
            access=access,
            control=PageControl(loop.post, loop.beat, loop.silent),
            feed=feed,
            supervisor=supervisor,
            sessions=sessions,
            scratch=scratch,
        )
        server = uvicorn.Server(_uvicorn(create_app(hub, inner), tls))
        logging.getLogger("uvicorn.error").addFilter(_is_news)
        loop.start()
        stack.callback(loop.stop)
        view.start()
        supervisor.start()
        stack.callback(supervisor.stop)
        if config.host not in LOOPBACK_HOSTS:
            log.warning("%s", exposure(access))
        yield server, listener, page_url(access)


def _uvicorn(app: ASGIApp, tls: dict[str, Any]) -> uvicorn.Config:
    LimitedHttp.most = room_for_connections()
    return uvicorn.Config(
        app,
        log_level="warning",
        access_log=False,
        # These, and no other that may be installed: `client_limits` builds on them.
        loop="asyncio",
        http=LimitedHttp,
        ws=LimitedWebSocket,
        ws_max_size=MAX_SOCKET_MESSAGE,
        ws_per_message_deflate=False,
        ws_ping_interval=20.0,
        server_header=False,
        timeout_graceful_shutdown=2,
        **tls,
    )


def checked_tls(config: ServeConfig) -> dict[str, Any]:
    """uvicorn's options for --cert and --key; StudioError if they cannot be used."""
    if config.cert is None and config.key is None:
        return {}
    if config.cert is None or config.key is None:
        raise StudioError("--cert and --key go together: give both, or neither")
    try:
        context = ssl.SSLContext(ssl.PROTOCOL_TLS_SERVER)
        context.load_cert_chain(config.cert, config.key, password=lambda: "")
    except (OSError, ValueError) as error:  # ssl.SSLError is an OSError
        why = error.strerror or str(error)
        raise StudioError(
            f"--cert {config.cert} and --key {config.key} cannot be used ({why}): give a "
            "certificate and its key in PEM, the key without a password"
        ) from error
    return {"ssl_certfile": str(config.cert), "ssl_keyfile": str(config.key)}


def exposure(access: AccessConfig) -> str:
    """What listening beyond this machine means, and what others need."""
    where = "every network of this machine" if access.host in EVERYWHERE else access.host
    how = (
        "encrypted"
        if access.secure
        else "NOT encrypted (--cert, --key): token, takes and camera can be read on the way"
    )
    names = (
        ", ".join(sorted(access.hosts - LOOPBACK_HOSTS - EVERYWHERE))
        or "this machine's own names only"
    )
    return (
        f"listening on {where}; {how}. Whoever has the token drives the robot, and reads, changes "
        f"and deletes takes. Answering to {names} (add names with --allow-host)"
    )


def _is_news(record: logging.LogRecord) -> bool:
    """Not what a stranger can have written as often as they like, nor a WebSocket refused with a
    status of our own, which uvicorn takes for an accident."""
    said = record.getMessage()
    return not any(known in said for known in NO_NEWS)


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
