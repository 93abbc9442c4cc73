"""Training as a process of its own: started, watched through its progress file, cancelled."""

import json
import os
import secrets
import subprocess
import sys
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.training import parent_watch

MOST_POINTS = 300
"""Points of a loss curve sent to a page; longer ones are thinned."""


@dataclass(kw_only=True)
class Job:
    """One training. status: running | done | failed | cancelled."""

    name: str
    process: subprocess.Popen[bytes]
    progress: Path
    errors: Path
    cancelled: bool = False

    @property
    def status(self) -> str:
        """How it stands."""
        code = self.process.poll()
        if code is None:
            return "running"
        if self.cancelled:
            return "cancelled"
        return "done" if code == 0 else "failed"

    def let_go(self) -> None:
        """Of the process, which has ended."""
        if self.process.stdin is not None:
            self.process.stdin.close()

    def as_dict(self) -> dict[str, Any]:
        """Progress for a page: per state the step, the loss curve, and in the end the scores."""
        events = read_events(self.progress)
        states: dict[str, dict[str, Any]] = {}
        counts: dict[str, int] = {}
        without: dict[str, str] = {}
        last: dict[str, Any] = {}
        for event in events:
            last = event
            if event["event"] == "pairs":
                counts, without = event["counts"], event["left_out"]
            if event["event"] == "loss":
                row = states.setdefault(event["state"], {"curve": []})
                row["step"], row["steps"] = event["step"], event["steps"]
                row["curve"].append([event["step"], event["loss"]])
            elif event["event"] == "scores":
                states.setdefault(event["state"], {"curve": []})["result"] = event
        for row in states.values():
            row["curve"] = row["curve"][:: max(1, -(-len(row["curve"]) // MOST_POINTS))]
        why = last.get("why", "")
        if self.status == "failed" and not why:
            why = self.errors.read_text(errors="replace").strip()[-400:] or "the training ended"
        return {
            "name": self.name,
            "status": self.status,
            "event": last.get("event", "starting"),
            "seconds": last.get("t", 0.0),
            "counts": counts,
            "left_out": without,
            "states": states,
            "why": " ".join(why.split()),
        }


def read_events(file: Path) -> list[dict[str, Any]]:
    """The whole lines of a progress file; the last may be half written."""
    try:
        lines = file.read_bytes().splitlines(keepends=True)
    except OSError:
        return []
    return [json.loads(line) for line in lines if line.endswith(b"\n")]


class TrainJobs:
    """At most one training at a time, and how the last one went. Any thread."""

    def __init__(self, sessions: Path, scratch: Path) -> None:
        """scratch: a folder for progress files."""
        self.sessions, self._scratch = Path(sessions), scratch
        self._lock = threading.Lock()
        self.job: Job | None = None

    def start(self, name: str, options: Sequence[str]) -> Job:
        """`a1-studio train mapper` with `options`; StudioError while another one runs."""
        with self._lock:
            if self.job is not None and self.job.status == "running":
                raise StudioError(f"mapper {self.job.name} is being trained: cancel it, or wait")
            if self.job is not None:
                self.job.let_go()
            stem = self._scratch / f"train-{secrets.token_hex(4)}"
            progress, errors = stem.with_suffix(".jsonl"), stem.with_suffix(".err")
            command = [
                sys.executable, "-m", "studio", "train", "mapper", *options, "--name", name,
                "--sessions", str(self.sessions), "--progress", str(progress), "--json", os.devnull,
            ]  # fmt: skip
            with errors.open("wb") as file:
                process = subprocess.Popen(
                    command,
                    stdout=subprocess.DEVNULL,
                    stderr=file,
                    # Held open by us alone: closed by the system when we end, even by kill −9.
                    stdin=subprocess.PIPE,
                    env={**os.environ, "OMP_NUM_THREADS": "1", parent_watch.VARIABLE: "1"},
                )
            # The loop comes first: training takes what is left. Set from here: between fork and
            # exec of a process with threads no Python may run.
            os.setpriority(os.PRIO_PROCESS, process.pid, os.nice(0) + 10)
            self.job = Job(name=name, process=process, progress=progress, errors=errors)
            return self.job

    def cancel(self) -> Job:
        """End the running training; StudioError if there is none."""
        with self._lock:
            if self.job is None or self.job.status != "running":
                raise StudioError("no training is running")
            self.job.cancelled = True
            self.job.process.terminate()
            try:
                self.job.process.wait(timeout=5.0)
            except subprocess.TimeoutExpired:
                self.job.process.kill()
                self.job.process.wait()
            return self.job

    def close(self) -> None:
        """Let no process linger; idempotent."""
        if self.job is not None:
            if self.job.status == "running":
                self.cancel()
            self.job.let_go()
