"""The API's schema without a server: what `a1-studio openapi` prints."""

import tempfile
from pathlib import Path
from typing import Any

from studio.live.loop import LiveLoop
from studio.live.runtime import RuntimeConfig
from studio.web.access import AccessConfig
from studio.web.desk import ControlDesk
from studio.web.feed import TickFeed
from studio.web.gateway import create_api
from studio.web.hub import Hub
from studio.web.keeper import Keeper


def openapi() -> dict[str, Any]:
    """OpenAPI 3.1 of every path, with what the sockets send among its components."""
    with tempfile.TemporaryDirectory(prefix="a1-studio-") as folder:
        loop = LiveLoop(RuntimeConfig(source="operator:quiet", sessions=Path(folder)))
        hub = Hub(
            loop=loop,
            access=AccessConfig(token="none", host="127.0.0.1", port=0),
            desk=ControlDesk(loop.post, loop.beat, loop.silent),
            feed=TickFeed(loop.ticks),
            keeper=Keeper(loop, {}),
            sessions=Path(folder),
            scratch=Path(folder),
        )
        try:
            return create_api(hub).openapi()
        finally:
            hub.close()
