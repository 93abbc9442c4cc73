"""Between a browser and the inner viser: its one HTML file, and its socket, both ways."""

import asyncio
import contextlib
import gzip
import logging
import time

import websockets.asyncio.client
from fastapi import APIRouter, Request, Response, WebSocket
from starlette.responses import RedirectResponse
from starlette.websockets import WebSocketDisconnect
from websockets.exceptions import ConnectionClosed, WebSocketException

from studio.web.guarded_viser import (
    SECRET_HEADER,
    GuardedViser,
    client_html,
    client_message_allowed,
)

log = logging.getLogger(__name__)
CAMERA_S = 0.1
"""s between cameras passed on: viser wants to know of one, and nothing here looks at any."""

# viser draws its own control panel, notifications and log lines over the canvas; ours is around it.
FRAME_TAGS = (
    '<link rel="stylesheet" href="/assets/css/frame.css"><script src="/assets/js/frame.js">'
)
FRAME_TAGS += "</script>"


def view_router(inner: GuardedViser) -> APIRouter:
    """`/view/`: the 3-D view as a page of its own, to be framed by ours."""
    router = APIRouter(include_in_schema=False)
    plain = client_html().replace("<script", FRAME_TAGS + "<script", 1).encode()
    packed = gzip.compress(plain, 6)

    @router.get("/view/")
    async def page(request: Request) -> Response:
        """The client; without a query, which could make it connect elsewhere."""
        if request.url.query:
            return RedirectResponse("/view/", status_code=303)
        if "gzip" in request.headers.get("accept-encoding", ""):
            headers = {"content-encoding": "gzip"}
            return Response(packed, media_type="text/html", headers=headers)
        return Response(plain, media_type="text/html")

    @router.websocket("/view")
    async def socket(ws: WebSocket) -> None:
        await relay(ws, inner)

    return router


async def relay(ws: WebSocket, inner: GuardedViser) -> None:
    """Join one browser to viser until either leaves."""
    protocols = ws.scope.get("subprotocols", [])
    protocol = next((p for p in protocols if p.startswith("viser-v")), None)
    if protocol is None:
        await ws.close(1002, "not a viser client")
        return
    try:
        async with websockets.asyncio.client.connect(
            f"ws://127.0.0.1:{inner.port}",
            subprotocols=[websockets.Subprotocol(protocol)],
            additional_headers={SECRET_HEADER: inner.secret},
            compression=None,
            max_size=None,
            ping_interval=None,
            proxy=None,
        ) as upstream:
            await ws.accept(subprotocol=protocol)
            down = asyncio.create_task(_downstream(upstream, ws))
            up = asyncio.create_task(_upstream(ws, upstream))
            try:
                await asyncio.wait({down, up}, return_when=asyncio.FIRST_COMPLETED)
            finally:
                down.cancel()
                up.cancel()
                await asyncio.gather(down, up, return_exceptions=True)
    except (OSError, WebSocketException):
        log.warning("the 3-D view is not reachable", exc_info=True)
    finally:
        if ws.application_state.name != "DISCONNECTED":
            with contextlib.suppress(RuntimeError, WebSocketDisconnect):  # it closed first
                await ws.close(1001)


async def _downstream(upstream: websockets.asyncio.client.ClientConnection, ws: WebSocket) -> None:
    try:
        async for message in upstream:
            await ws.send_bytes(message)  # type: ignore[arg-type]
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        pass


async def _upstream(ws: WebSocket, upstream: websockets.asyncio.client.ClientConnection) -> None:
    sent = -CAMERA_S
    try:
        while True:
            raw = (await ws.receive()).get("bytes")
            if ws.client_state.name == "DISCONNECTED":
                return
            now = time.monotonic()
            if raw is not None and now - sent >= CAMERA_S and client_message_allowed(raw):
                sent = now
                await upstream.send(raw)
    except (ConnectionClosed, WebSocketDisconnect, RuntimeError):
        pass
