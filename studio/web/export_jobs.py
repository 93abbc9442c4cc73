"""Many takes to a file to be downloaded, in a process of its own: watched, cancelled, kept."""

import asyncio
import secrets
import shutil
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, Literal

from studio.errors import StudioError
from studio.files import write_whole
from studio.takes.export.many import Exported, export_many
from studio.web.worker_process import WorkerProcess


@dataclass(kw_only=True)
class Job:
    """One export, as `as_dict` tells of it. folder: where it is made."""

    id: str
    format: str
    total: int
    folder: Path
    status: Literal["running", "done", "failed", "cancelled"] = "running"
    result: Exported | None = None
    why: str = ""
    task: "asyncio.Task[None] | None" = field(default=None, repr=False)

    def as_dict(self) -> dict[str, Any]:
        """For a page."""
        made = self.result
        return {
            "id": self.id,
            "status": self.status,
            "format": self.format,
            "done": self.total if made else self._done(),
            "total": self.total,
            "left_out": made.left_out if made else {},
            "file": made.file.name if made else "",
            "bytes": made.file.stat().st_size if made else 0,
            "why": self.why,
        }

    def _done(self) -> int:
        try:
            return int((self.folder / PROGRESS).read_text())
        except (OSError, ValueError):
            return 0


PROGRESS = "done"


class ExportJobs:
    """At most one export at a time; the file of the last one is kept. The event loop's thread."""

    def __init__(self, sessions: Path, scratch: Path) -> None:
        self._sessions, self._scratch = Path(sessions), scratch / "exports"
        self._process = WorkerProcess()
        self.job: Job | None = None

    def start(self, names: Sequence[str], format_name: str, title: str, *, rejected: bool) -> Job:
        """Begin; StudioError while another one runs."""
        if self.job is not None and self.job.status == "running":
            raise StudioError("another export is being made: cancel it, or wait")
        self._forget()
        id = secrets.token_hex(8)
        job = Job(id=id, format=format_name, total=len(names), folder=self._scratch / id)
        job.folder.mkdir(parents=True)
        job.task = asyncio.create_task(self._run(job, names, title, rejected))
        self.job = job
        return job

    async def _run(self, job: Job, names: Sequence[str], title: str, rejected: bool) -> None:
        try:
            job.result = await self._process.run(
                _export, self._sessions, names, job.format, job.folder, title, rejected
            )
            job.status = "done"
        except (StudioError, OSError) as error:
            if job.status == "running":
                job.status, job.why = "failed", str(error)
            shutil.rmtree(job.folder, ignore_errors=True)

    async def cancel(self) -> Job:
        """End the running export; StudioError if there is none."""
        job = self.job
        if job is None or job.status != "running":
            raise StudioError("nothing is being exported")
        job.status = "cancelled"
        self._process.close()
        if job.task is not None:
            await job.task
        return job

    def file(self, id: str) -> Path:
        """The file of an export that is done; StudioError for any other."""
        if self.job is None or self.job.id != id or self.job.result is None:
            raise StudioError("there is no such export any more: export the takes again")
        return self.job.result.file

    def close(self) -> None:
        """Let no process linger; idempotent."""
        if self.job is not None and self.job.status == "running":
            self.job.status = "cancelled"
        self._process.close()

    def _forget(self) -> None:
        if self.job is not None:
            shutil.rmtree(self.job.folder, ignore_errors=True)
            self.job = None


def _export(
    sessions: Path, names: Sequence[str], format: str, folder: Path, title: str, rejected: bool
) -> Exported:
    """In the other process."""
    said = folder / PROGRESS
    made = folder / "made"
    made.mkdir()
    return export_many(
        sessions, names, format, made, title, rejected=rejected,
        at=lambda done: write_whole(said, str(done)),
    )  # fmt: skip
