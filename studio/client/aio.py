"""The same studio for programs on asyncio: requests go by a thread, sockets by the event loop."""

import asyncio
import functools
from collections.abc import Callable, Coroutine
from typing import Any, Concatenate, ParamSpec, TypeVar, Unpack

from studio.client.async_sockets import AsyncFrames, AsyncTicks
from studio.client.http import Options
from studio.client.sync import Studio

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

    def frames(self) -> AsyncFrames:
        """As `Studio.frames`, for `async with`."""
        return AsyncFrames(self.studio.address)

    def ticks(self) -> AsyncTicks:
        """As `Studio.ticks`, for `async with`."""
        return AsyncTicks(self.studio.address)
