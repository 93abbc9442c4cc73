"""How a WebSocket is opened, and what is said on it: the same for both clients."""

import json
from collections.abc import Sequence
from typing import Any

from websockets.exceptions import InvalidStatus

from studio.client.http import Address, ClientError, reason
from studio.client.messages import Frame, Point

ENDED = "the studio has ended the connection"


def socket_options(address: Address) -> dict[str, Any]:
    """How our WebSockets are opened: straight there, uncompressed, for both are quick on a LAN."""
    return {
        "additional_headers": address.headers,
        "ssl": address.tls,
        "proxy": None,
        "compression": None,
        "open_timeout": address.timeout,
    }


def not_opened(error: Exception, address: Address) -> ClientError:
    """Why a WebSocket was not opened."""
    if isinstance(error, InvalidStatus):
        status = error.response.status_code
        return ClientError(reason(bytes(error.response.body or b""), status), status)
    return ClientError(f"{address.nobody} ({error})")


def frame_text(
    t: float, skeleton: str, positions: Sequence[Point], confidence: Sequence[float] | None
) -> str:
    """A frame as it is sent; numpy's rows and numbers are welcome."""
    frame: Frame = {
        "t": float(t),
        "skeleton": skeleton,
        "positions": [None if p is None else [float(x) for x in p] for p in positions],
    }
    if confidence is not None:
        frame["confidence"] = [float(c) for c in confidence]
    return json.dumps(frame)


def error_in(message: str | bytes) -> str:
    """What an answer to a frame says."""
    return str(json.loads(message).get("error", message))
