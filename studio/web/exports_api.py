"""Exports of many takes over HTTP: start, watch, cancel, download."""

from typing import Any

from fastapi import APIRouter
from fastapi.responses import FileResponse
from pydantic import Field

from studio.errors import StudioError, unknown_name
from studio.live.command import Body
from studio.takes.export.formats import FORMATS
from studio.takes.export.many import of_session
from studio.takes.session_library import SessionLibrary
from studio.web.answers import answers, refusing
from studio.web.answers_takes import Export
from studio.web.export_jobs import ExportJobs
from studio.web.hub import Hub, OffThread, refused


class ExportBody(Body):
    """Either takes, or a session: all of it but what was rejected. format: as `takes export`."""

    takes: list[str] = Field(default=[], max_length=10_000)
    session: str | None = Field(default=None, max_length=120)
    format: str = "takes"


def exports_router(hub: Hub) -> APIRouter:
    """`/api/exports`."""
    router = APIRouter(prefix="/api/exports", tags=["takes"])
    jobs = ExportJobs(hub.sessions, hub.scratch)
    hub.at_close.append(jobs.close)
    library = SessionLibrary(hub.sessions)
    off_thread = OffThread(hub.workers, 422)

    def chosen(body: ExportBody) -> tuple[list[str], str]:
        """Names, and what the file is called."""
        if body.format not in FORMATS:
            raise unknown_name("format", body.format, FORMATS)
        if bool(body.takes) == (body.session is not None):
            raise StudioError("say which takes, or which session")
        if body.session is not None:
            return of_session(library, body.session), body.session
        for name in body.takes:
            library.folder(name)
        first, more = body.takes[0], len(body.takes) - 1
        return body.takes, f"{first}-and-{more}-more" if more else first

    @router.post("", **answers(Export, 409, 422))
    async def start(body: ExportBody) -> dict[str, Any]:
        """Begin to make one file of many takes: a data set, or a zip of a file each."""
        names, title = await off_thread(chosen, body)
        try:
            job = jobs.start(names, body.format, title, rejected=body.session is None)
        except StudioError as error:
            raise refused(str(error)) from error
        return job.as_dict()

    @router.get("", **answers(Export | None))
    async def progress() -> dict[str, Any] | None:
        """The last export; null before the first."""
        return None if jobs.job is None else jobs.job.as_dict()

    @router.post("/cancel", **answers(Export, 409))
    async def cancel() -> dict[str, Any]:
        """End it; nothing is kept of it."""
        try:
            return (await jobs.cancel()).as_dict()
        except StudioError as error:
            raise refused(str(error)) from error

    @router.get("/{id}/file", responses=refusing(404))
    async def file(id: str) -> FileResponse:
        """The file, once it is done; it stays until the next export begins."""
        try:
            path = jobs.file(id)
        except StudioError as error:
            raise refused(str(error), 404) from error
        return FileResponse(path, filename=path.name)

    return router
