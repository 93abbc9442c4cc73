"""uvicorn as the studio runs it: its listening socket, its limits, what it does not log."""

import errno
import logging
import socket
from typing import Any

import uvicorn
from starlette.types import ASGIApp

from studio.errors import StudioError
from studio.web.client_limits import LimitedHttp, LimitedWebSocket, room_for_connections

MAX_SOCKET_MESSAGE = 2 * 1024 * 1024
"""Bytes: frames of up to 1 MB must be answered, not closed on."""
NO_NEWS = (
    "without completing handshake",
    "Invalid HTTP request received",
    "Unsupported upgrade request",
    "No supported WebSocket library",
    "Invalid UTF-8 sequence received",
)


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


def uvicorn_config(app: ASGIApp, options: dict[str, Any]) -> uvicorn.Config:
    """options: more of uvicorn's."""
    logging.getLogger("uvicorn.error").addFilter(_is_news)
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
        **options,
    )


def _is_news(record: logging.LogRecord) -> bool:
    """Not what a stranger can have written as often as they like, nor a WebSocket refused with a
    status of our own, which uvicorn takes for an accident."""
    said = record.getMessage()
    return not any(known in said for known in NO_NEWS)
