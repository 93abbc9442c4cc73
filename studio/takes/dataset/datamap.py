"""The takes of a folder to one map: what is covered by state and range, and what to record next.

Counts per take add up, so a take is looked at once, and again only when its edits change.
"""

from collections.abc import Iterable
from pathlib import Path
from typing import Any

import numpy as np

from studio.errors import StudioError
from studio.reference.intent import STATES
from studio.robot.a1 import CONTROL_DT
from studio.takes.columns import columns
from studio.takes.dataset import coverage as cover
from studio.takes.dataset.coverage import AXES, ENOUGH, Coverage
from studio.takes.edit.edited import kept
from studio.takes.edit.edits import EDITS, read_edits
from studio.takes.record.meta import read_meta
from studio.takes.session_library import SessionLibrary

TASK_OF = {"forward": "walk"}
"""What the map calls a task and the library calls otherwise."""


class DataMap:
    """Remembers each take's counts. One thread at a time."""

    def __init__(self, root: Path) -> None:
        self.library = SessionLibrary(root)
        self._known: dict[str, tuple[int, Coverage | None]] = {}

    def read(self) -> Coverage:
        """The map of every take that was not rejected."""
        infos = {info.name: info for info in self.library.list() if not info.recording}
        self._known = {name: v for name, v in self._known.items() if name in infos}
        parts = []
        for name, info in infos.items():
            key = self._key(name)
            if name not in self._known or self._known[name][0] != key:
                self._known[name] = key, self._look(name)
            found = self._known[name][1]
            if found is not None and info.kept is not False:
                parts.append(found)
        return merged(parts)

    def as_dict(self) -> dict[str, Any]:
        """Plain values: per state its seconds, share covered and bins per axis; proposals."""
        found = self.read()
        return {
            "enough": ENOUGH,
            "states": {
                state: {
                    "seconds": round(found.seconds[state], 1),
                    "share": round(found.share(state), 3),
                    "axes": [
                        {
                            "name": axis.name,
                            "unit": axis.unit,
                            "task": TASK_OF.get(axis.task, axis.task),
                            "edges": list(axis.edges),
                            "counts": found.counts[state][axis.name].tolist(),
                        }
                        for axis in AXES[state]
                    ],
                }
                for state in STATES
            },
            "proposals": [
                {"task": TASK_OF.get(task, task), "why": why} for task, why in found.proposals
            ],
        }

    def _key(self, name: str) -> int:
        folder = self.library.root / name
        try:
            return folder.stat().st_mtime_ns + (folder / EDITS).stat().st_mtime_ns
        except OSError:
            return 0

    def _look(self, name: str) -> Coverage | None:
        folder = self.library.root / name
        try:
            table = columns(folder)
            collected = (read_meta(folder).get("about") or {}).get("collect") or {}
        except StudioError:
            return None
        rows = table.rows[kept(len(table), read_edits(folder).edits)]
        state = np.array(table.names or ("",))[np.asarray(rows["state"])]
        if collected.get("state") in STATES:
            state = np.full(len(rows), collected["state"])
        segments: dict[str, list[dict[str, Any]]] = {}
        for one in STATES:
            mine = rows[state == one]
            if len(mine) > 1:
                pose = (
                    np.asarray(mine[f"reference_{key}"], dtype=np.float64)
                    for key in ("base_pos", "base_quat", "joint_pos")
                )
                segments[one] = [cover.values(one, *pose, dt=CONTROL_DT)]
        return cover.coverage(segments, CONTROL_DT)


def merged(parts: Iterable[Coverage]) -> Coverage:
    """The map of all parts together."""
    total = cover.coverage({}, CONTROL_DT)
    counts, seconds = total.counts, total.seconds
    for part in parts:
        for state, axes in part.counts.items():
            seconds[state] += part.seconds[state]
            for axis, bins in axes.items():
                counts[state][axis] = counts[state][axis] + bins
    return Coverage(counts=counts, seconds=seconds, proposals=cover._proposals(counts))
