"""The best run of each person in each scene: one small file beside the takes, written whole."""

import logging
import threading
from datetime import UTC, datetime
from pathlib import Path
from typing import Annotated

import msgspec
from typing_extensions import TypedDict

from studio.errors import StudioError
from studio.files import open_regular, write_whole
from studio.live.disk_writer import DiskWriter
from studio.options import SCENES
from studio.scenes.scene import Scene
from studio.scenes.stage import Stage
from studio.sim.prop_world import PropPoses

Props = tuple[Scene, PropPoses] | None
"""A scene with props, and where they are."""
log = logging.getLogger(__name__)
FILE = ".best-runs.json"
"""Beside the takes; no take's name begins with a dot."""
MAX_BYTES = 1_000_000
MAX_NAME, MAX_PEOPLE = 40, 100
"""Letters of a person's name; people who are kept in a scene."""


class _Run(msgspec.Struct):
    score: Annotated[int, msgspec.Meta(ge=0, le=1_000_000)]
    time_s: Annotated[float, msgspec.Meta(ge=0.0, le=1e6)]
    source: Annotated[str, msgspec.Meta(max_length=40)]
    when: Annotated[str, msgspec.Meta(max_length=40)]

    @property
    def rank(self) -> tuple[float, float]:
        """Less is better."""
        return -self.score, self.time_s


_Name = Annotated[str, msgspec.Meta(min_length=1, max_length=MAX_NAME)]
_Kept = dict[str, dict[_Name, _Run]]
_LOCK = threading.Lock()


class BestRun(TypedDict):
    """A person's best run in a scene. source: what drove ("operator", "webcam", "stream" …). when:
    ISO 8601, UTC."""

    person: str
    score: int
    time_s: float
    source: str
    when: str


def checked_name(name: str) -> str:
    """A person's name as it is kept; "" for nobody. StudioError for one that cannot be shown."""
    name = " ".join(name.split())
    if len(name) > MAX_NAME or not name.isprintable():
        raise StudioError(f"a name has at most {MAX_NAME} letters, all of them to be seen")
    return name


class BestRuns:
    """What the file holds; any thread. One that cannot be read counts as empty, and is said so."""

    def __init__(self, sessions: str | Path) -> None:
        self._path = Path(sessions) / FILE

    def of(self, scene: str) -> list[BestRun]:
        """Of a scene, the best first."""
        rows = sorted(self._read().get(scene, {}).items(), key=lambda row: row[1].rank)
        return [BestRun(person=name, **msgspec.structs.asdict(run)) for name, run in rows]

    def add(self, scene: str, person: str, score: int, time_s: float, source: str) -> None:
        """Keep a run if it is the person's best. StudioError if it cannot be written."""
        when = datetime.now(UTC).isoformat(timespec="seconds")
        run = _Run(score=score, time_s=time_s, source=source[:40], when=when)
        with _LOCK:
            kept = self._read()
            runs = kept.setdefault(scene, {})
            if person in runs and runs[person].rank <= run.rank:
                return
            runs[person] = run
            best = sorted(runs.items(), key=lambda row: row[1].rank)[:MAX_PEOPLE]
            kept[scene] = dict(best)
            try:
                write_whole(self._path, msgspec.json.encode(kept), parents=True)
            except OSError as error:
                why = f"the best run was not kept: {error.strerror or error}"
                raise StudioError(why) from error

    def _read(self) -> _Kept:
        if not self._path.exists():
            return {}
        try:
            with open_regular(self._path, MAX_BYTES) as file:
                kept = msgspec.json.decode(file.read(), type=_Kept)
        except (StudioError, OSError, msgspec.DecodeError, RecursionError) as error:
            log.warning("best runs are left out: %s", error)
            return {}
        return {scene: runs for scene, runs in kept.items() if scene in SCENES}


class SceneRuns:
    """Who plays, and the keeping of what they finish. The loop's thread calls it."""

    def __init__(self, sessions: str | Path) -> None:
        self.person = ""
        self._best, self._writer = BestRuns(sessions), DiskWriter()
        self._counted = True

    def watch(self, stage: Stage, source: str) -> Props:
        """Once a control period: a scene that has just been finished is somebody's run, unless the
        robot was pushed meanwhile. Returns where its props are."""
        if not stage.finished:
            self._counted = False
        elif not self._counted:
            self._counted = True
            run = stage.progress()
            if self.person and not stage.pushed:
                args = stage.name, self.person, run["score"], run["time_s"]
                self._writer.do(lambda: self._best.add(*args, source.partition(":")[0]))
        poses = stage.prop_poses()
        return None if poses is None else (stage.scene, poses)

    def close(self) -> None:
        """Wait until all is written."""
        self._writer.close()
