"""What a data set version says of itself, typed."""

from pathlib import Path
from typing import Any

import msgspec

from studio.takes.untrusted import Count, Name, read_json


class _TakeRow(msgspec.Struct):
    name: Name
    tape: Name
    edits: dict[str, Any]
    pairs: Count


class _Manifest(msgspec.Struct):
    """The types of what is read from a manifest; more may be in it."""

    version: Name
    made: Name
    format_version: int
    code: Name
    states: list[Name]
    style: Name
    content: Name
    count: Count
    takes: list[_TakeRow]
    statistics: dict[str, Any]


_any = msgspec.json.Decoder(dict[str, Any])


def read_manifest(path: Path, format_version: int) -> dict[str, Any]:
    """A manifest.json; of another format only what it says its format is, and when it was made.

    Raises OSError, and ValueError where it is damaged.
    """
    manifest = read_json(path, _any)
    try:
        kind = _Manifest if manifest.get("format_version") == format_version else _Any
        msgspec.convert(manifest, kind)
    except msgspec.ValidationError as error:
        raise ValueError(str(error)) from None
    return manifest


class _Any(msgspec.Struct):
    """Of any format."""

    format_version: int
    made: Name = ""
