"""Ticks as the bytes that sockets send."""

from typing import Any

import msgspec

from studio.takes.as_json import plain, tick_dict
from studio.takes.tick import Tick

__all__ = ["plain", "tick_json"]


def tick_json(tick: Tick, **more: Any) -> bytes:
    """UTF-8 JSON of `as_json.tick_dict` with further keys."""
    return msgspec.json.encode({**tick_dict(tick), **more})
