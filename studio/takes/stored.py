"""Bytes that lay on a disk to values of a declared type, or one reason why not.

Whatever lies in a sessions folder came from outside: another program, another machine, a torn
write. Sizes are checked before anything is read whole, types before anything is believed.
"""

import os
import stat
from pathlib import Path
from typing import Annotated, TypeVar

import msgspec

T = TypeVar("T")

MOST_JSON = 16 << 20
"""Bytes of a JSON file beside a tape; ours have some hundred."""

Name = Annotated[str, msgspec.Meta(max_length=200)]
"""A state, an expert, a mode."""
Line = Annotated[str, msgspec.Meta(max_length=10_000)]
Count = Annotated[int, msgspec.Meta(ge=0, le=2**40)]
Seconds = Annotated[float, msgspec.Meta(ge=-1e12, le=1e12)]
"""Of any source's clock."""


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
    """A regular file whole; ValueError for another kind or more than `most` bytes, OSError."""
    # A FIFO would keep whoever opens it until somebody writes.
    handle = os.open(path, os.O_RDONLY | os.O_NONBLOCK)
    with os.fdopen(handle, "rb") as file:
        about = os.fstat(handle)
        if not stat.S_ISREG(about.st_mode):
            raise ValueError("it is no file")
        if about.st_size > most:
            raise ValueError(f"it holds {about.st_size} bytes, at most {most} are read")
        return file.read(most)
