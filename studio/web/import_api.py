"""What was recorded elsewhere, sent by a page, to takes: folders, zips, and people's motions.

Names from outside are made fit before they are part of any path.
"""

import secrets
import shutil
from pathlib import Path
from typing import Any, BinaryIO

from fastapi import APIRouter, Request
from starlette.datastructures import FormData, UploadFile

from studio.errors import StudioError
from studio.mocap.imports import KINDS, take_in
from studio.takes.export.archive import FILES
from studio.takes.names import fit_name
from studio.web.answers import answers
from studio.web.answers_takes import Imported
from studio.web.hub import Hub, OffThread, refused

MAX_BODY = 2 * 2**30
"""Bytes of one request: ten hours of tape."""
SMALL = 256 * 1024
"""Bytes that are taken in sooner than a process is begun: 20 s of BVH. Zips may hold more."""
BODY = {
    "requestBody": {
        "required": True,
        "content": {
            "multipart/form-data": {
                "schema": {
                    "type": "object",
                    "properties": {
                        "files": {"type": "array", "items": {"type": "string", "format": "binary"}},
                        "name": {"type": "string", "description": "of the take, where one is sent"},
                        "robot": {"type": "string", "description": "take whose robot is shown"},
                    },
                    "required": ["files"],
                }
            }
        },
    }
}


def import_router(hub: Hub) -> APIRouter:
    """`POST /import`, below `/api/takes`."""
    router = APIRouter(tags=["takes"])

    @router.post("/import", openapi_extra=BODY, **answers(Imported, 411, 413, 415, 422, 507))
    async def import_(request: Request) -> dict[str, Any]:
        """Files of one take (tape.mcap, meta.json, edits.jsonl), a .zip of takes, or a motion file.

        Answers takes: their names here; refused: {name: why}; rejected: frames left out.
        """
        length = request.headers.get("content-length", "")
        if not length.isdigit():
            raise refused("say how long the files are (Content-Length)", 411)
        if int(length) > MAX_BODY:
            raise refused(f"more than {MAX_BODY // 2**30} GB at once: import fewer takes", 413)
        if "multipart/form-data" not in request.headers.get("content-type", ""):
            raise refused(f"{KINDS}, as multipart/form-data", 415)
        async with request.form(max_files=len(FILES), max_fields=4) as form:
            return await _take_in(hub, form)

    return router


async def _take_in(hub: Hub, form: FormData) -> dict[str, Any]:
    """Import the files of a form; 422 with why, where none of them became a take."""
    files = [f for f in form.getlist("files") if isinstance(f, UploadFile) and f.filename]
    name, robot = (str(form.get(key) or "").strip() or None for key in ("name", "robot"))
    off_thread = OffThread(hub.workers, 422)
    folder = hub.scratch / "imports" / secrets.token_hex(4) / fit_name(name or "take")
    try:
        folder.mkdir(parents=True)
        stored = [folder / _file_name(f.filename or "") for f in files]
        for file, path in zip(files, stored):
            await off_thread(_store, file.file, path)
        zipped = any(path.suffix.lower() == ".zip" for path in stored)
        if not zipped and sum(path.stat().st_size for path in stored) < SMALL:
            return await off_thread(take_in, hub.sessions, stored, robot)
        return await hub.worker_process.run(take_in, hub.sessions, stored, robot)
    except StudioError as error:
        raise refused(str(error), 422) from error
    except OSError as error:
        raise refused(f"nothing was imported: {error.strerror or error}", 507) from error
    finally:
        shutil.rmtree(folder.parent, ignore_errors=True)


def _file_name(sent: str) -> str:
    """A take's own file names as they are; any other: its stem made fit, and its suffix."""
    last = sent.replace("\\", "/").rpartition("/")[2]
    if last in FILES:
        return last
    stem, dot, suffix = last.rpartition(".")
    return f"{fit_name(stem or suffix, 'motion')}{dot}{fit_name(suffix, 'x') if dot else ''}"


def _store(source: BinaryIO, path: Path) -> None:
    source.seek(0)
    with path.open("wb") as out:
        shutil.copyfileobj(source, out, 1 << 20)
