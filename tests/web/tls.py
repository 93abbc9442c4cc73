"""A WebSocket over TLS, read and written by one thread.

websockets' own for threads reads it from a second one: before Python 3.13 two threads spoil a TLS
connection now and then (10 of 600 were never answered).
"""

import asyncio
from collections.abc import Iterator
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any

from websockets.asyncio.client import connect


@contextmanager
def tls_socket(url: str, headers: dict[str, str], trust: Any) -> Iterator[SimpleNamespace]:
    """`send(message)` and `recv(timeout)`; raises what `connect` raises."""
    with asyncio.Runner() as runner:

        async def opened() -> Any:
            return await connect(url, ssl=trust, additional_headers=headers, proxy=None)

        async def received(timeout: float) -> str | bytes:
            return await asyncio.wait_for(ws.recv(), timeout)

        ws = runner.run(opened())
        try:
            yield SimpleNamespace(
                send=lambda message: runner.run(ws.send(message)),
                recv=lambda timeout: runner.run(received(timeout)),
            )
        finally:
            runner.run(ws.close())
