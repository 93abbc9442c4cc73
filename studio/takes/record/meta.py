"""A take's `meta.json`: what was recorded, when, from which source; how it is written and read."""

from pathlib import Path
from typing import Any

import msgspec

from studio.errors import StudioError
from studio.files import write_whole
from studio.takes.untrusted import Count, Line, Name, Seconds, read_json

TAPE, META = "tape.mcap", "meta.json"
FORMAT_VERSION = 1
"""Major version of a take's folder; another one is refused."""


class _Collected(msgspec.Struct):
    task: Name = ""
    state: Name = ""
    operator: Name = ""
    session: Name = ""


class _About(msgspec.Struct):
    source: Line = ""
    style: Name = ""
    robot: Name = ""
    collect: _Collected | None = None


class _Meta(msgspec.Struct):
    """The types of what others read from meta.json; more may be in it."""

    label: Line = ""
    started: Name = ""
    ticks: Count = 0
    seconds: Seconds = 0.0
    about: _About | None = None


_meta = msgspec.json.Decoder(dict[str, Any])


class MetaLost(StudioError):
    """meta.json is missing or damaged: the tape can still be read."""


def read_meta(folder: Path) -> dict[str, Any]:
    """A take's meta.json; StudioError if it is missing, damaged or of another major version."""
    try:
        meta = read_json(folder / META, _meta)
        version = meta["format_version"]
        if version == FORMAT_VERSION:
            msgspec.convert(meta, _Meta)
    except (OSError, ValueError, KeyError, msgspec.MsgspecError) as error:
        raise MetaLost(f"{META} of take {folder.name} is missing or damaged") from error
    if version != FORMAT_VERSION:
        by = str(meta.get("studio_version", "version unknown"))[:20]
        raise StudioError(
            f"take {folder.name} has format {str(version)[:20]}, this studio reads"
            f" {FORMAT_VERSION}: open it with the a1-studio it was recorded with ({by}), export"
            " the person there as BVH or JSON lines, and import that"
        )
    return meta


def write_meta(folder: Path, meta: dict[str, Any]) -> None:
    """Replace meta.json whole."""
    write_whole(folder / META, msgspec.json.format(msgspec.json.encode(meta), indent=2))
