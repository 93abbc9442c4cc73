"""Takes over HTTP: list, edit, undo, export, throw into the bin."""

import secrets
import shutil
from typing import Any

import msgspec
from fastapi import APIRouter
from fastapi.responses import FileResponse, Response
from pydantic import Field, StrictBool
from starlette.background import BackgroundTask

from studio.live.command import Body, Number
from studio.takes.export.formats import export_file as export_take
from studio.takes.listing import TakeInfo
from studio.takes.session_library import SessionLibrary
from studio.web.answers import answers, refusing
from studio.web.answers_takes import Deleted
from studio.web.hub import Hub, OffThread
from studio.web.import_api import import_router

Pair = tuple[Number, Number]


class EditBody(Body):
    """Any of a take's edits; what is left out stays."""

    label: str | None = Field(default=None, max_length=120)
    note: str | None = Field(default=None, max_length=4000)
    trim: Pair | None = None
    lag: Number | None = None
    warp: list[Pair] | None = None
    cuts: list[Pair] | None = None
    keep: StrictBool | None = None
    score: Number | None = None


def takes_router(hub: Hub) -> APIRouter:
    """`/api/takes`."""
    router = APIRouter(prefix="/api/takes", tags=["takes"])
    router.include_router(import_router(hub))
    library = SessionLibrary(hub.sessions)

    off_thread = OffThread(hub.workers, 404)

    @router.get("", **answers(list[TakeInfo]))
    async def takes() -> Response:
        """Every take: name, label, seconds, ticks, score, kept."""
        # Encoded here, off the event loop: ten thousand would hold it up for half a second.
        found = await off_thread(lambda: msgspec.json.encode(library.list()), status=500)
        return Response(found, media_type="application/json")

    @router.get("/{name}", **answers(TakeInfo, 404))
    async def one(name: str) -> dict[str, Any]:
        """One take."""
        return (await off_thread(library.info, name)).as_dict()

    @router.patch("/{name}", **answers(TakeInfo, 404, 422))
    async def edit(name: str, body: EditBody) -> dict[str, Any]:
        """Label, note, trim, lag, keep, score. The tape itself is never touched."""
        changes = body.model_dump(exclude_unset=True)
        await off_thread(library.folder, name)
        return (await off_thread(library.edit, name, status=422, **changes)).as_dict()

    @router.delete("/{name}", **answers(Deleted, 404, 409))
    async def delete(name: str) -> dict[str, Any]:
        """Into the bin."""
        await off_thread(library.folder, name)
        await off_thread(library.delete, name, status=409)
        return {"name": name, "deleted": True}

    @router.post("/{name}/undo", **answers(TakeInfo, 404, 409))
    async def undo(name: str) -> dict[str, Any]:
        """Take the last edit back."""
        await off_thread(library.folder, name)
        return (await off_thread(library.undo, name, status=409)).as_dict()

    @router.post("/{name}/redo", **answers(TakeInfo, 404, 409))
    async def redo(name: str) -> dict[str, Any]:
        """Do it again."""
        await off_thread(library.folder, name)
        return (await off_thread(library.redo, name, status=409)).as_dict()

    @router.get("/{name}/export", responses=refusing(404, 422))
    async def export(name: str, format: str = "npz") -> FileResponse:
        """A file: jsonl, bvh (the person), npz, csv (both), pairs, hdf5, lerobot (zip), html."""
        take = await off_thread(library.read, name)
        place = hub.scratch / "exports" / secrets.token_hex(4)
        place.mkdir(parents=True)
        try:
            path = await off_thread(export_take, take, format, place, status=422)
        except BaseException:
            shutil.rmtree(place, ignore_errors=True)
            raise
        thrown_away = BackgroundTask(shutil.rmtree, place, ignore_errors=True)
        return FileResponse(path, filename=path.name, background=thrown_away)

    return router
