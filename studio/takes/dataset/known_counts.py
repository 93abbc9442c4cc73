"""How many pairs of each state takes have, each counted once, and again when it has changed."""

from pathlib import Path

from studio.takes.dataset.pairs import pair_counts
from studio.takes.edit.edits import EDITS
from studio.takes.record.meta import TAPE
from studio.takes.session_library import SessionLibrary


class KnownCounts:
    """Remembers each take's. Any thread."""

    def __init__(self, library: SessionLibrary) -> None:
        self.library = library
        self._known: dict[str, tuple[tuple[int, ...], dict[str, int]]] = {}

    def of(self, name: str) -> dict[str, int]:
        """Pairs by state, as `pair_counts` tells them. StudioError as that."""
        folder = self.library.folder(name)
        stamp = tuple(_changed(folder / part) for part in (TAPE, EDITS))
        known = self._known.get(name)
        if known is None or known[0] != stamp:
            known = self._known[name] = stamp, pair_counts(self.library, name)
        return known[1]


def _changed(file: Path) -> int:
    """ns; 0 for what is not there."""
    try:
        return file.stat().st_mtime_ns
    except OSError:
        return 0
