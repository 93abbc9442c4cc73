"""A take whose writer was killed, or whose files are damaged, to one that any reader opens."""

from datetime import datetime
from pathlib import Path
from typing import Any

from studio import __version__
from studio.errors import StudioError
from studio.robot import a1
from studio.takes import bin
from studio.takes.listing import is_recording
from studio.takes.record import codec
from studio.takes.record.meta import FORMAT_VERSION, TAPE, MetaLost, read_meta, write_meta
from studio.takes.record.tape import TapeScan, rewrite_chunked, scan
from studio.takes.take import iter_ticks


def repair(root: Path, folder: Path) -> dict[str, Any]:
    """Make a take whole: {"name", "ticks", "seconds", "repaired", "lost", "bin"}.

    Its whole ticks become a tape with index and footer, meta.json is made again where it is lost,
    and the take as it was lies in the bin. lost: what could not be read, or "". A take that is
    whole is left alone. Raises StudioError while it is recorded, and when it holds no whole tick.
    """
    if is_recording(folder):
        raise StudioError(f"take {folder.name} is being recorded: stop it first")
    found, states, people = TapeScan(), {}, 0
    ticks = 0
    for tick in iter_ticks(folder, found):
        states[tick.state] = states.get(tick.state, 0) + 1
        ticks += 1
    meta, lost = _meta(folder)
    answer = {"name": folder.name, "ticks": ticks, "seconds": round(ticks / a1.CONTROL_HZ, 6)}
    if found.complete and not lost and meta.get("ticks") == ticks:
        return answer | {"repaired": False, "lost": "", "bin": None}
    if not ticks:
        raise StudioError(f"take {folder.name} holds no whole tick that could be saved: delete it")
    kept = bin.keep_copy(root, folder)
    try:
        rewrite_chunked(folder / TAPE, codec.SCHEMAS, ticks)
        for message in scan(folder / TAPE, TapeScan()):
            people += message.topic == "human"
        about = {
            "ticks": ticks,
            "seconds": answer["seconds"],
            "human_frames": people,
            "state_seconds": {k: v / a1.CONTROL_HZ for k, v in states.items()},
            "repaired": datetime.now().astimezone().isoformat(timespec="seconds"),
        }
        write_meta(folder, meta | about | {"complete": True})
    except OSError as error:
        raise StudioError(f"take {folder.name} was not repaired: {error.strerror}") from error
    return answer | {"repaired": True, "lost": found.problem, "bin": str(kept)}


def _meta(folder: Path) -> tuple[dict[str, Any], bool]:
    """meta.json, or what the tape tells of it; and whether it was lost."""
    try:
        return read_meta(folder), False
    except MetaLost:
        first = next(scan(folder / TAPE, TapeScan()), None)
        began = 0 if first is None else first.time
    return {
        "format": "a1-studio take",
        "format_version": FORMAT_VERSION,
        "name": folder.name,
        "label": "",
        "started": datetime.fromtimestamp(began / 1e9).astimezone().isoformat("T", "milliseconds"),
        "started_ns": began,
        "control_hz": a1.CONTROL_HZ,
        "studio_version": __version__,
        "about": {},
    }, True
