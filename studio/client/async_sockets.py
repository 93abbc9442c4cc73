"""The studio's WebSockets, frames in and ticks out, on an event loop: for both clients."""

import asyncio
import json
from collections.abc import AsyncIterator, Sequence
from typing import Self

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from studio.client.http import Address, ClientError
from studio.client.messages import Point, Skeleton, Tick
from studio.client.wire import ENDED, error_in, frame_text, not_opened, socket_options


class AsyncSocket:
    """One WebSocket, open within an `async with`."""

    path: str

    def __init__(self, address: Address) -> None:
        self._address = address
        self._ws: ClientConnection

    async def __aenter__(self) -> Self:
        try:
            self._ws = await connect(
                self._address.socket(self.path), **socket_options(self._address)
            )
        except (OSError, InvalidHandshake) as error:
            raise not_opened(error, self._address) from error
        return self

    async def __aexit__(self, *_: object) -> None:
        await self._ws.close()

    async def _receive(self, timeout: float | None) -> str | bytes:
        try:
            async with asyncio.timeout(timeout):
                return await self._ws.recv()
        except ConnectionClosed as error:
            raise ClientError(ENDED) from error


class AsyncFrames(AsyncSocket):
    """As `Frames`."""

    path = "/api/human"
    refused: int = 0

    async def send(
        self,
        t: float,
        skeleton: Skeleton,
        positions: Sequence[Point],
        confidence: Sequence[float] | None = None,
    ) -> list[str]:
        """As `Frames.send`."""
        try:
            await self._ws.send(frame_text(t, skeleton, positions, confidence))
        except ConnectionClosed as error:
            raise ClientError(ENDED) from error
        return await self.errors()

    async def errors(self, timeout: float = 0.0) -> list[str]:
        """As `Frames.errors`."""
        found: list[str] = []
        try:
            while True:
                found.append(error_in(await self._receive(0.0 if found else timeout)))
        except TimeoutError:
            self.refused += len(found)
            return found


class AsyncTicks(AsyncSocket):
    """As `Ticks`, for `async for`."""

    path = "/api/ticks"

    async def __aiter__(self) -> AsyncIterator[Tick]:
        try:
            async for message in self._ws:
                yield json.loads(message)
        except ConnectionClosed:
            return

    async def next(self, timeout: float | None = None) -> Tick:
        """As `Ticks.next`."""
        try:
            return json.loads(await self._receive(timeout))
        except TimeoutError as error:
            raise ClientError(f"no tick within {timeout:g} s") from error
