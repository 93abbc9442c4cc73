"""`a1-studio serve`: loop, view and gateway in one process, one URL, a clean end."""

import contextlib
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

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.files import scratch_folder, sweep, sweep_writes
from studio.link.udp import open_link
from studio.live.commands.mappers import map_by
from studio.live.loop import LiveLoop
from studio.live.mappers import FOLDER as MAPPERS
from studio.live.mappers import open_given
from studio.live.runtime import Runtime, RuntimeConfig
from studio.options import ServeConfig
from studio.takes.export import adding
from studio.training.rivals import OURS
from studio.web.access import AccessConfig, page_url
from studio.web.feed import TickFeed
from studio.web.gateway import create_app
from studio.web.guarded_viser import GuardedViser
from studio.web.hosts import EVERYWHERE, LOOPBACK_HOSTS, checked_names
from studio.web.http_server import bind, uvicorn_config
from studio.web.hub import Hub
from studio.web.page_control import PageControl
from studio.web.phone_door import second_server
from studio.web.scene import StudioScene
from studio.web.second_server import FirstServer
from studio.web.supervisor import Supervisor
from studio.web.tokens import checked_token, kept_token
from studio.web.view import View

log = logging.getLogger(__name__)
SCRATCH = "a1-studio-"
"""Beginning of a studio's temporary folder."""


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
                travel=config.travel,
                steps=config.steps,
            ),
        )
        scratch = stack.enter_context(scratch_folder(SCRATCH))
        link = open_link(config.robot, config.robot_level, config.robot_secret)
        loop = LiveLoop(runtime=_mapped_by(config.mapper, Runtime(runtime, link=link)))
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
        app = create_app(hub, inner)
        server = uvicorn.Server(uvicorn_config(app, tls))
        if config.phone is not None:
            second = second_server(config.phone, config.phone_port, hub, app.app)
            stack.callback(second.listener.close)
            server = FirstServer(server.config, second)
        loop.start()
        stack.callback(loop.stop)
        view.start()
        supervisor.start()
        stack.callback(supervisor.stop)
        if config.host not in LOOPBACK_HOSTS:
            log.warning("%s", exposure(access))
        yield server, listener, page_url(access)


def _mapped_by(name: str, runtime: Runtime) -> Runtime:
    """The same, by the mapper of --mapper; what takes long is done before anything moves."""
    if name != OURS:
        style = runtime.config.puppeteer.style
        try:
            opened = open_given(runtime.config.sessions, name, style, runtime.mappers)
        except BaseException:
            runtime.close()
            raise
        map_by(runtime, opened)
    return runtime


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
