"""A datagram → the OSC messages in it that are wanted, or FrameRejected: nothing else ever leaves.

OSC 1.0: a message is an address, type tags and arguments; a bundle holds messages and bundles.
"""

from collections.abc import Collection, Iterator
from typing import Any

from pythonosc.osc_message import OscMessage

from studio.mocap.raw_frame import FrameRejected

MAX_PACKET = 16_384
"""Bytes of a datagram: an avatar of 55 bones and 52 expressions in one bundle takes some 8 kB."""
MAX_MESSAGE = 512
MAX_DEPTH = 4
"""Bundles within bundles."""
_BUNDLE = b"#bundle\0"
_HEAD = len(_BUNDLE) + 8
"""Bytes before a bundle's first element: its name and its time tag."""
_TAGS = b"sifd"


def read_packet(packet: bytes, wanted: Collection[bytes]) -> list[tuple[str, list[Any]]]:
    """(address, arguments) of each message in `packet` whose address is wanted, in order.

    Arguments are str, int and float. Messages to other addresses are not looked into. Raises
    FrameRejected where any part of the packet is damaged.
    """
    if len(packet) > MAX_PACKET:
        raise FrameRejected(f"a packet of more than {MAX_PACKET} bytes: split it")
    return list(_elements(packet, wanted, 0))


def _elements(
    data: bytes, wanted: Collection[bytes], depth: int
) -> Iterator[tuple[str, list[Any]]]:
    if not data.startswith(_BUNDLE):
        yield from _message(data, wanted)
        return
    # Taken apart here: python-osc goes round for ever at an element of negative size.
    if depth >= MAX_DEPTH or len(data) < _HEAD:
        raise FrameRejected(f"a damaged OSC bundle, or more than {MAX_DEPTH} within each other")
    at = _HEAD
    while at < len(data):
        size = int.from_bytes(data[at : at + 4], "big")
        at += 4
        if not 0 < size <= len(data) - at:
            raise FrameRejected("an OSC bundle that ends within one of its elements")
        yield from _elements(data[at : at + size], wanted, depth + 1)
        at += size


def _message(data: bytes, wanted: Collection[bytes]) -> Iterator[tuple[str, list[Any]]]:
    address = data.partition(b"\0")[0]
    if not address.startswith(b"/"):
        raise FrameRejected("no OSC: a message begins with /, a bundle with #bundle")
    if address not in wanted:
        return
    tags = data[len(address) // 4 * 4 + 4 :].partition(b"\0")[0]
    if len(data) > MAX_MESSAGE or not tags.startswith(b",") or tags[1:].translate(None, _TAGS):
        raise FrameRejected(f"{address.decode()} with arguments other than words and numbers")
    try:
        message = OscMessage(data)
        yield message.address, message.params
    except Exception as error:  # of many kinds, as the bytes have it
        why = " ".join(str(error).split())[:80]
        raise FrameRejected(f"{address.decode()} is damaged: {why}") from None
