"""The three sockets: human frames in, ticks out, and a page's heartbeat with its emergency stop."""

import asyncio
import contextlib
import json
import logging
from typing import Any

from fastapi import APIRouter, WebSocket
from starlette.websockets import WebSocketDisconnect

from studio.errors import StudioError
from studio.live.commands import Stop
from studio.web.hub import Hub

log = logging.getLogger(__name__)
STATE_HZ = 10.0
MAX_KEYS = 16
MAX_MESSAGE = 4096
"""Bytes of a page's message: what is larger is not read."""
GONE = (WebSocketDisconnect, RuntimeError)
"""What sending to, or reading from, a closed socket raises."""


def sockets_router(hub: Hub) -> APIRouter:
    """WS /api/human, /api/ticks and /api/control."""
    router = APIRouter()

    @router.websocket("/api/human")
    async def human(ws: WebSocket) -> None:
        """Frames in; a bad one is answered {"error": …} and counted, and closes nothing."""
        await ws.accept()
        hub.loop.new_sender()
        with contextlib.suppress(*GONE):
            while True:
                message = await ws.receive()
                if message["type"] == "websocket.disconnect":
                    return
                raw = message.get("text") or message.get("bytes") or b""
                error = take_frame(hub, raw)
                if error:
                    await ws.send_json({"error": error})

    @router.websocket("/api/ticks")
    async def ticks(ws: WebSocket) -> None:
        """Ticks out, as JSON; who reads slowly misses some."""
        await ws.accept()
        subscriber = hub.feed.subscribe()
        reader = asyncio.create_task(_until_closed(ws))
        try:
            async for frame in subscriber:
                if reader.done():
                    return
                await ws.send_text(frame.decode())
        except GONE:
            pass
        finally:
            hub.feed.unsubscribe(subscriber)
            reader.cancel()

    @router.websocket("/api/control")
    async def control(ws: WebSocket) -> None:
        """A page's own socket: heartbeats and stops in, the state ten times a second out."""
        await ws.accept()
        page = hub.desk.join()
        sender = asyncio.create_task(_send_state(ws, hub, page.name))
        try:
            while True:
                message = await ws.receive()
                if message["type"] == "websocket.disconnect":
                    return
                said = message.get("text") or message.get("bytes") or b""
                answer = await page_message(hub, page.name, said)
                if answer is not None:
                    await ws.send_json(answer)
        except GONE:
            pass
        finally:
            hub.desk.leave(page.name)
            sender.cancel()

    return router


def take_frame(hub: Hub, raw: str | bytes) -> str:
    """Give one message to the loop's stream; what is wrong with it, or ""."""
    try:
        hub.loop.push_frame(raw)
    except StudioError as error:
        return str(error)
    return ""


async def page_message(hub: Hub, page: str, said: str | bytes) -> dict[str, Any] | None:
    """Act on one message of a page; an answer, or None. Nonsense is answered, never fatal.

    A stop is acknowledged with the `number` it came with and `stops`, how many there were by then;
    its sender has to be alarmed where that fails to come.
    """
    if len(said) > MAX_MESSAGE:
        return {"type": "error", "error": f"a message has at most {MAX_MESSAGE} bytes"}
    try:
        message = json.loads(said)
        kind = message["type"]
        if kind == "stop":
            number = message.get("number")
            result = await hub.submit(Stop(by=page))
            return {
                "type": "stopped",
                "number": number if isinstance(number, int) else None,
                "stops": result.state.get("stops"),
                "ok": result.ok,
                "why": result.why,
            }
        if kind == "beat":
            keys = frozenset(str(k)[:16] for k in list(message.get("keys", []))[:MAX_KEYS])
            hub.desk.beat(
                page,
                visible=bool(message.get("visible", True)),
                keys=keys,
                round_trip_ms=float(message.get("round_trip_ms", 0.0)),
            )
            hub.drive(page, keys)
            return {"type": "beat", "sent": message.get("sent")}
    except (ValueError, TypeError, KeyError, RecursionError):
        return {"type": "error", "error": 'send {"type": "beat"} or {"type": "stop"}'}
    return {"type": "error", "error": f"unknown type {str(kind)[:32]!r}; known: beat, stop"}


async def _send_state(ws: WebSocket, hub: Hub, page: str) -> None:
    with contextlib.suppress(*GONE):
        while True:
            await ws.send_text(hub.state_json(type="state", page=page).decode())
            await asyncio.sleep(1.0 / STATE_HZ)


async def _until_closed(ws: WebSocket) -> None:
    """Read and forget what a listener says, until it leaves."""
    with contextlib.suppress(*GONE):
        while (await ws.receive())["type"] != "websocket.disconnect":
            pass
