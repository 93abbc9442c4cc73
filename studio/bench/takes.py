"""What takes cost as there are more of them and longer ones: to list, review and scrub."""

import json
import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice
from pathlib import Path
from typing import Any

import numpy as np

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.evaluation.behind import drive, met
from studio.robot.a1 import CONTROL_DT, CONTROL_HZ
from studio.sources import open_source
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.tick import Tick

TAKES = 10_000
MINUTES = (6.0, 60.0)
"""Lengths reviewed: memory is bounded if ten times as long a take needs about as much."""
PATTERN_S = 30.0
SCRUBS = 200


def takes_cost(takes: int = TAKES, minutes: tuple[float, ...] = MINUTES) -> dict[str, Any]:
    """{"list", "long"}: seconds to list many takes, and what a long take costs at each length."""
    with tempfile.TemporaryDirectory(prefix="a1-bench-") as folder:
        pattern = performed(PATTERN_S)
        listed = listing(Path(folder) / "many", pattern, takes)
        return {"list": listed, "long": [long_take(Path(folder), pattern, m) for m in minutes]}


def performed(seconds: float) -> list[Tick]:
    """Ticks of the operator's tour, as the flow makes them."""
    source = open_source("operator")
    puppeteer = met(source, PuppeteerConfig(controller="pd_playback"))
    return list(drive(puppeteer, source, seconds))


def listing(root: Path, pattern: list[Tick], takes: int) -> dict[str, float]:
    """Seconds of wall time to list `takes` takes: for the first time, and after it (p50, p95)."""
    recorder = Recorder(root)
    name = recorder.start("walk", name="t00000")
    for tick in pattern[:30]:
        recorder.append(tick)
    recorder.close()
    files = [(file.name, file.read_bytes()) for file in (root / name).iterdir()]
    for i in range(1, takes):
        folder = root / f"t{i:05d}"
        folder.mkdir()
        for file, data in files:
            (folder / file).write_bytes(data)
    library = SessionLibrary(root)
    first, again = _seconds(library.list), [_seconds(library.list) for _ in range(20)]
    p50, p95 = np.percentile(again, [50, 95])
    return {"takes": takes, "first_s": first, "p50_s": float(p50), "p95_s": float(p95)}


def long_take(root: Path, pattern: list[Tick], minutes: float) -> dict[str, float]:
    """Record a take of that length with the real recorder, then look at it in a fresh process.

    Each figure in the unit that its name ends in.
    """
    name = f"long-{60 * minutes:.0f}s"
    recorder = Recorder(root)
    began = time.perf_counter()
    recorder.start("tour", name=name)
    count = 0
    for tick in islice(repeated(pattern), round(60.0 * minutes * CONTROL_HZ)):
        recorder.append(tick)
        count += 1
    appended = time.perf_counter() - began
    recorder.close()
    closed = time.perf_counter() - began - appended
    size = (root / name / "tape.mcap").stat().st_size
    return {
        "minutes": minutes,
        "append_us": 1e6 * appended / count,
        "finish_s": closed,
        "tape_mb": size / 1e6,
        **_looked_at(root, name),
    }


def repeated(pattern: list[Tick]) -> Iterator[Tick]:
    """The ticks over and over, times going on."""
    lap = 0
    while True:
        later = lap * len(pattern) * CONTROL_DT
        for i, tick in enumerate(pattern):
            human = tick.human and replace(tick.human, t=tick.human.t + later)
            robot = replace(tick.robot, t=tick.robot.t + later)
            yield replace(
                tick, index=lap * len(pattern) + i, t=tick.t + later, human=human, robot=robot
            )
        lap += 1


def _looked_at(root: Path, name: str) -> dict[str, float]:
    done = subprocess.run(
        [sys.executable, "-m", "studio.bench.takes", str(root), name],
        capture_output=True,
        text=True,
        check=False,
    )
    if done.returncode:
        raise StudioError(f"take {name} was not reviewed: {done.stderr.strip()[-300:]}")
    return json.loads(done.stdout)


def look_at(root: Path, name: str) -> dict[str, float]:
    """Review, timeline and scrubbing of a take: seconds, and by how many MB this process grew.

    review_*_mb: at its largest, of memory of its own; mapped files, which the system takes back
    when it needs room, are counted in `review_mapped_mb` besides.
    """
    from studio.takes.edit import edited, review, windows
    from studio.takes.edit.edited import Viewed

    library = SessionLibrary(root)
    before = _memory()
    with _Peak() as peak:
        build = _seconds(lambda: edited.open_table(root, name))
        first = _seconds(lambda: review.review(library, name))
        again = _seconds(lambda: review.review(library, name))
        table, edits = edited.open_table(root, name)
        timeline = _seconds(lambda: windows.overview(table, edits))
    mapped = _memory()["RssFile"] - before["RssFile"]
    take = Viewed(name, table, edits)
    at = np.random.default_rng(0).uniform(0.0, table.seconds, SCRUBS)
    seeks = [_seconds(lambda t=t: take.at(float(t))) for t in at]
    parts = [_seconds(lambda t=t: windows.window(table, edits, t, t + 10.0)) for t in at]
    return {
        "table_s": build,
        "review_s": first,
        "review_again_s": again,
        "timeline_s": timeline,
        "review_own_mb": peak.most - before["RssAnon"],
        "review_mapped_mb": mapped,
        "seek_ms_p95": 1e3 * float(np.percentile(seeks, 95)),
        "window_ms_p95": 1e3 * float(np.percentile(parts, 95)),
    }


class _Peak:
    """The most memory of its own this process had meanwhile, MB, looked at every 5 ms."""

    def __enter__(self) -> "_Peak":
        import threading

        self.most, self._done = _memory()["RssAnon"], threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)
        self._thread.start()
        return self

    def _watch(self) -> None:
        while not self._done.wait(0.005):
            self.most = max(self.most, _memory()["RssAnon"])

    def __exit__(self, *_: object) -> None:
        self._done.set()
        self._thread.join()


def _memory() -> dict[str, float]:
    """RssAnon and RssFile of this process, MB; zero where the system does not tell."""
    out = {"RssAnon": 0.0, "RssFile": 0.0}
    try:
        lines = Path("/proc/self/status").read_text().splitlines()
    except OSError:
        return out
    for line in lines:
        key, _, value = line.partition(":")
        if key in out:
            out[key] = float(value.split()[0]) / 1024.0
    return out


def _seconds(work: Any) -> float:
    began = time.perf_counter()
    work()
    return time.perf_counter() - began


if __name__ == "__main__":
    sys.stdout.write(json.dumps(look_at(Path(sys.argv[1]), sys.argv[2])))
