"""What a page says on its own socket: bytes from anywhere → a heartbeat or a stop, typed."""

import re
from typing import Annotated

import msgspec

from studio.errors import StudioError

MAX_MESSAGE = 4096
"""Bytes of a page's message: what is larger is not read."""
MAX_KEYS = 16
_EXACT = re.compile(rb"-?\d{1,15}")  # integers that are the same number in every program


class Beat(msgspec.Struct, tag_field="type", tag="beat", frozen=True):
    """The page lives. keys: held down. sent: its own clock, given back to it. round_trip_ms: ms
    that the last beat took to come back."""

    keys: list[Annotated[str, msgspec.Meta(max_length=64)]] = []
    visible: bool = True
    sent: float | None = None
    round_trip_ms: Annotated[float, msgspec.Meta(ge=0.0)] = 0.0


class StopSaid(msgspec.Struct, tag_field="type", tag="stop", frozen=True):
    """An emergency stop, whatever else the message says. number: its sender's, to tell answers
    apart."""

    number: msgspec.Raw = msgspec.Raw(b"null")

    @property
    def told(self) -> int | None:
        """The number, where it is one that every program reads alike."""
        said = bytes(self.number)
        return int(said) if _EXACT.fullmatch(said) else None


_DECODER = msgspec.json.Decoder(Beat | StopSaid)


def page_message(said: str | bytes) -> Beat | StopSaid:
    """Raises StudioError saying what would be understood."""
    if len(said) > MAX_MESSAGE:
        raise StudioError(f"a message has at most {MAX_MESSAGE} bytes")
    try:
        return _DECODER.decode(said)
    except (msgspec.MsgspecError, ValueError, RecursionError) as error:
        why = str(error).encode("ascii", "replace").decode()[:200]
        raise StudioError(
            f'send {{"type": "beat"}} or {{"type": "stop"}} in JSON: {why}'
        ) from error
