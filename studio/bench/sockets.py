"""WebSockets to a studio as its pages open them."""

from importlib.metadata import version
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from websockets.sync.client import ClientConnection

VIEW = "/view"


def page_socket(port: int, token: str, path: str, **options: Any) -> "ClientConnection":
    """A socket of a page on loopback; VIEW speaks viser's protocol. options: of `connect`."""
    from websockets.sync.client import connect

    return connect(
        f"ws://127.0.0.1:{port}{path}",
        additional_headers={"Authorization": f"Bearer {token}"},
        subprotocols=[f"viser-v{version('viser')}"] if path == VIEW else None,  # type: ignore[list-item]
        max_size=None,
        proxy=None,
        **options,
    )
