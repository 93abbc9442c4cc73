"""The same studio for programs on asyncio: requests go by a thread, sockets by the event loop."""

import asyncio
import functools
import json
from collections.abc import AsyncIterator, Callable, Coroutine, Sequence
from typing import Any, Concatenate, ParamSpec, Self, TypeVar, Unpack

from websockets.asyncio.client import ClientConnection, connect
from websockets.exceptions import ConnectionClosed, InvalidHandshake

from studio.client.http import Address, ClientError, Options
from studio.client.messages import Point, Skeleton, Tick
from studio.client.sync import Studio
from studio.client.wire import ENDED, error_in, frame_text, not_opened, socket_options

P = ParamSpec("P")
T = TypeVar("T")


def _awaited(
    method: Callable[Concatenate[Studio, P], T],
) -> "Callable[Concatenate[AsyncStudio, P], Coroutine[Any, Any, T]]":
    @functools.wraps(method)
    async def call(self: "AsyncStudio", *args: P.args, **kwargs: P.kwargs) -> T:
        return await asyncio.to_thread(method, self.studio, *args, **kwargs)

    return call


class AsyncStudio:
    """As `Studio`, each method a coroutine."""

    def __init__(self, url: str, token: str | None = None, **options: Unpack[Options]) -> None:
        self.studio = Studio(url, token, **options)

    state = _awaited(Studio.state)
    set_mode = _awaited(Studio.set_mode)
    lock_state = _awaited(Studio.lock_state)
    set_source = _awaited(Studio.set_source)
    set_scene = _awaited(Studio.set_scene)
    stop = _awaited(Studio.stop)
    reset = _awaited(Studio.reset)
    arm = _awaited(Studio.arm)
    transport = _awaited(Studio.transport)
    takes = _awaited(Studio.takes)
    take = _awaited(Studio.take)
    start_take = _awaited(Studio.start_take)
    stop_take = _awaited(Studio.stop_take)
    edit_take = _awaited(Studio.edit_take)
    undo_take = _awaited(Studio.undo_take)
    delete_take = _awaited(Studio.delete_take)
    export_take = _awaited(Studio.export_take)

    def frames(self) -> "AsyncFrames":
        """As `Studio.frames`, for `async with`."""
        return AsyncFrames(self.studio.address)

    def ticks(self) -> "AsyncTicks":
        """As `Studio.ticks`, for `async with`."""
        return AsyncTicks(self.studio.address)


class _Socket:
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


class AsyncFrames(_Socket):
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


class AsyncTicks(_Socket):
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
