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
from studio.web.page_messages import MAX_KEYS, StopSaid, page_message

log = logging.getLogger(__name__)
STATE_HZ = 10.0
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
                    await _send(ws, {"error": error})

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
        page = hub.control.join()
        sender = asyncio.create_task(_send_state(ws, hub, page.name))
        try:
            while True:
                message = await ws.receive()
                if message["type"] == "websocket.disconnect":
                    return
                said = message.get("text") or message.get("bytes") or b""
                await answer(hub, ws, page.name, said)
        except GONE:
            pass
        finally:
            hub.control.leave(page.name)
            sender.cancel()

    return router


def take_frame(hub: Hub, raw: str | bytes) -> str:
    """Give one message to the loop's stream; what is wrong with it, or ""."""
    try:
        hub.loop.push_frame(raw)
    except StudioError as error:
        return str(error)
    return ""


async def answer(hub: Hub, ws: WebSocket, page: str, said: str | bytes) -> None:
    """Act on one message of a page and answer it. Nonsense is answered, never fatal."""
    try:
        message = page_message(said)
    except StudioError as error:
        await _send(ws, {"type": "error", "error": str(error)})
        return
    if isinstance(message, StopSaid):
        with hub.stop_order.under_way() as leaves:
            answered = await stopped(hub, page, message)
            leaves()
            await _send(ws, answered)
        return
    keys = frozenset(key[:16] for key in message.keys[:MAX_KEYS])
    hub.control.beat(page, visible=message.visible, keys=keys, round_trip_ms=message.round_trip_ms)
    hub.drive(page, keys)
    await _send(ws, {"type": "beat", "sent": message.sent})


async def stopped(hub: Hub, page: str, message: StopSaid) -> dict[str, Any]:
    """Stop, and acknowledge it with the `number` it came with and `stops`, how many there were by
    then; its sender has to be alarmed where that fails to come."""
    result = await hub.submit(Stop(by=page))
    return {
        "type": "stopped",
        "number": message.told,
        "stops": result.state.get("stops"),
        "ok": result.ok,
        "why": result.why,
    }


async def _send(ws: WebSocket, message: dict[str, Any]) -> None:
    # In ASCII: what a sender is told of its own words may be no text in UTF-8.
    await ws.send_text(json.dumps(message, allow_nan=False))


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
