"""Bytes that lay on a disk to values of a declared type, or one reason why not.

Whatever lies in a sessions folder came from outside: another program, another machine, a torn
write. Sizes are checked before anything is read whole, types before anything is believed.
"""

import os
from pathlib import Path
from typing import Annotated, TypeVar

import msgspec

from studio.files import opened

T = TypeVar("T")

MOST_JSON = 16 << 20
"""Bytes of a JSON file beside a tape; ours have some hundred."""

MOST_UNPACKED = 1 << 33
"""Bytes that one file may unpack to: forty hours of takes."""
SMALL, RATIO = 1 << 26, 200
"""Of a smaller file at most RATIO times its size (of ours some ten times), but always SMALL."""

Name = Annotated[str, msgspec.Meta(max_length=200)]
"""A state, an expert, a mode."""
Line = Annotated[str, msgspec.Meta(max_length=10_000)]
Count = Annotated[int, msgspec.Meta(ge=0, le=2**40)]
Seconds = Annotated[float, msgspec.Meta(ge=-1e12, le=1e12)]
"""Of any source's clock."""


def may_unpack(packed: int) -> int:
    """Bytes that `packed` bytes from elsewhere may unpack to before they are taken for a bomb."""
    return min(MOST_UNPACKED, max(SMALL, RATIO * packed))


def decoded(data: bytes, decoder: msgspec.json.Decoder[T]) -> T:
    """What the JSON says, of the decoder's type; ValueError with a line that says why not."""
    try:
        return decoder.decode(data)
    except RecursionError:
        raise ValueError("it is nested too deeply") from None
    except msgspec.MsgspecError as error:
        raise ValueError(str(error)[:200]) from None


def read_json(path: Path, decoder: msgspec.json.Decoder[T], most: int = MOST_JSON) -> T:
    """The same of a regular file of at most `most` bytes; OSError where it cannot be read."""
    return decoded(read_bytes(path, most), decoder)


def read_bytes(path: Path, most: int = MOST_JSON) -> bytes:
    """A regular file whole; ValueError for more than `most` bytes, OSError as `files.opened`."""
    with opened(path) as file:
        size = os.fstat(file.fileno()).st_size
        if size > most:
            raise ValueError(f"it holds {size} bytes, at most {most} are read")
        return file.read(most)
