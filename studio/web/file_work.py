"""What the helper's process does (`web.helper`). Imports nothing of the web."""

from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.mocap.imports import SUFFIXES, import_take
from studio.takes.export import adding
from studio.takes.record.meta import TAPE

KINDS = (
    f"send a take (its {TAPE}, with meta.json), a .zip of takes, a .bvh or human frames (.jsonl)"
)


def take_in(sessions: Path, stored: list[Path], robot: str | None) -> dict[str, Any]:
    """Import what a page has sent: {"takes", "refused", "rejected"}; StudioError if nothing was."""
    nothing = {"rejected": 0, "refused": {}}
    if any(file.name == TAPE for file in stored):
        taken, why = adding.add_all(sessions, [stored[0].parent])
        if not taken:
            raise StudioError("; ".join(why.values()))
        return nothing | {"takes": taken}
    if len(stored) == 1 and stored[0].suffix.lower() in (".zip", *SUFFIXES):
        return nothing | import_take(sessions, stored[0], robot=robot)
    raise StudioError(KINDS)
