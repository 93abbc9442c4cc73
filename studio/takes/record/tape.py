"""A tape is an MCAP file: JSON messages appended as they happen, whole again after a crash.

While recording, messages are written unchunked and flushed one by one: a killed process loses
none that was flushed. Afterwards the tape is rewritten in compressed, indexed chunks. Other
readers of MCAP want the second; `takes repair` makes it of the first. Reading scans records from
the front and stops at the first damage, so that a torn end costs only itself.
Format: https://mcap.dev/spec
"""

import io
import os
import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

import zstandard
from mcap.writer import CompressionType, Writer

from studio.errors import StudioError
from studio.files import opened, whole
from studio.takes.untrusted import MOST_UNPACKED, may_unpack

LIBRARY = "a1-studio"
MAGIC = b"\x89MCAP0\r\n"
_FOOTER, _CHANNEL, _MESSAGE, _CHUNK, _DATA_END = 2, 4, 5, 6, 15
CHUNK = 1 << 16
"""Bytes of a chunk before it is packed, about a second: the most a damaged end takes with it."""
_LARGEST_CHUNK = 1 << 26
"""Bytes: no record of ours is larger, nor what a chunk unpacks to; a larger claim is damage."""


@dataclass(frozen=True, kw_only=True)
class Message:
    """One row of a stream. time: ns since 1970, the one clock of all streams (a person's and the
    simulation's own are in the data)."""

    topic: str
    sequence: int
    time: int
    data: bytes


class TapeWriter:
    """Appends messages to one file. Opened by the thread that writes; `sync` may run on another."""

    def __init__(self, file: BinaryIO, schemas: dict[str, bytes], *, chunked: bool = False) -> None:
        """schemas: JSON schema of each stream that may be written."""
        self._file = file
        self._writer = Writer(
            file,
            use_chunking=chunked,
            chunk_size=CHUNK,
            compression=CompressionType.ZSTD if chunked else CompressionType.NONE,
        )
        self._writer.start(profile="", library=LIBRARY)
        self._chunked = chunked
        self._channels: dict[str, int] = {}
        for topic, schema in schemas.items():
            schema_id = self._writer.register_schema(f"studio.{topic}", "jsonschema", schema)
            self._channels[topic] = self._writer.register_channel(f"/{topic}", "json", schema_id)
        file.flush()

    def write(self, message: Message) -> None:
        """Append and, unless chunked, flush to the operating system. Raises OSError."""
        self._writer.add_message(
            channel_id=self._channels[message.topic],
            log_time=message.time,
            publish_time=message.time,
            sequence=message.sequence,
            data=message.data,
        )
        if not self._chunked:
            self._file.flush()

    def finish(self) -> None:
        """End the tape properly: index and footer, safe on disk."""
        self._writer.finish()
        self._file.flush()
        os.fsync(self._file.fileno())


@dataclass(kw_only=True)
class TapeScan:
    """What a scan found besides messages; filled while `messages` is consumed.

    complete: the tape was ended properly. problem: why reading stopped early, or "". left: bytes
    that its chunks may still unpack to.
    """

    complete: bool = False
    problem: str = ""
    left: int = MOST_UNPACKED


def scan(path: Path, found: TapeScan) -> Iterator[Message]:
    """Every whole message of a tape in file order, as far as it can be read.

    Raises StudioError if the file cannot be read or is no tape at all.
    """
    try:
        with opened(path) as file:
            magic = file.read(len(MAGIC))
            if magic != MAGIC and not MAGIC.startswith(magic):
                raise StudioError(f"{path.name} is no tape: an MCAP file was expected")
            if magic != MAGIC:
                found.problem = "nothing was recorded"
                return
            size = os.fstat(file.fileno()).st_size
            found.left = may_unpack(size)
            yield from _records(file, size, {}, found)
    except OSError as error:
        raise StudioError(f"cannot read {path.name}: {error.strerror}") from error


def _records(
    file: BinaryIO, end: int, channels: dict[int, str], found: TapeScan, *, packed: bool = False
) -> Iterator[Message]:
    while not found.complete and not found.problem:
        at = file.tell()
        head = file.read(9)
        if not head:
            return
        length = struct.unpack_from("<Q", head, 1)[0] if len(head) == 9 else end
        whole = length <= min(end - at - 9, _LARGEST_CHUNK)
        record = file.read(length) if whole else b""
        if len(record) < length:
            found.problem = f"the last {end - at} bytes are incomplete or damaged"
            return
        opcode = head[0]
        try:
            if opcode == _MESSAGE:
                channel, sequence, time, _ = struct.unpack_from("<HIQQ", record)
                if channel in channels:
                    topic, data = channels[channel], record[22:]
                    yield Message(topic=topic, sequence=sequence, time=time, data=data)
            elif opcode == _CHANNEL:
                (channel,) = struct.unpack_from("<H", record)
                (size,) = struct.unpack_from("<I", record, 4)
                channels[channel] = record[8 : 8 + size].decode().lstrip("/")
            elif opcode == _CHUNK:
                if packed:
                    raise ValueError("a chunk inside a chunk")
                plain = _unpack(record, found.left)
                found.left -= len(plain)
                yield from _records(io.BytesIO(plain), len(plain), channels, found, packed=True)
            elif opcode in (_DATA_END, _FOOTER):
                found.complete = True
        except (struct.error, UnicodeDecodeError, ValueError, zstandard.ZstdError) as error:
            found.problem = f"damaged at byte {at}: {error}"
            return


def _unpack(record: bytes, left: int) -> bytes:
    """The records inside a chunk, at most `left` bytes; ValueError when it is damaged."""
    size, crc = struct.unpack_from("<QI", record, 16)
    (name_size,) = struct.unpack_from("<I", record, 28)
    compression = record[32 : 32 + name_size].decode()
    start = 32 + name_size + 8
    packed = record[start:]
    if size > _LARGEST_CHUNK:
        raise ValueError("a chunk claims more than it can hold")
    if size > left:
        raise ValueError("the tape unpacks to more than a tape of its size holds")
    if compression == "zstd":
        # A size in the frame's own header would be believed before ours.
        if zstandard.frame_content_size(packed) > size:
            raise ValueError("a chunk holds more than it claims")
        plain = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
    elif compression == "":
        plain = packed
    else:
        raise ValueError(f"chunks packed with {compression[:20]!r} are not read here")
    if crc and zlib.crc32(plain) != crc:
        raise ValueError("a chunk's checksum is wrong")
    return plain


def rewrite_chunked(path: Path, schemas: dict[str, bytes], ticks: int | None = None) -> None:
    """Replace a tape by its compressed, indexed form: temporary file, fsync, rename.

    ticks: how many of its ticks are kept (all by default), where the end may be torn.
    Whatever interrupts it, either the old or the new tape is there whole. Raises OSError.
    """
    with whole(path) as temporary, temporary.open("wb") as file:
        writer = TapeWriter(file, schemas, chunked=True)
        for message in scan(path, TapeScan()):
            if message.topic in schemas and (ticks is None or message.sequence < ticks):
                writer.write(message)
        writer.finish()
    sync_folder(path.parent)


def sync_folder(folder: Path) -> None:
    """Make a rename in a folder survive power loss."""
    handle = os.open(folder, os.O_RDONLY)
    try:
        os.fsync(handle)
    finally:
        os.close(handle)
