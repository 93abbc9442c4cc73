"""Dropped motion files: a BVH or JSONL is checked whole, kept for this run, and made the source."""

import re
import secrets
from pathlib import Path
from typing import Any

from fastapi import APIRouter, HTTPException, Request

from studio.errors import StudioError
from studio.human.joint_names import UnmappedJoints
from studio.live.commands import SetSource
from studio.sources import FILES, open_source
from studio.web.answers import State, answers
from studio.web.hub import Hub, OffThread, refused

MAX_FILE = 64 * 1024 * 1024
"""Bytes: ten minutes of 120 Hz BVH are 40 MB."""


def safe_name(name: str) -> str:
    """The file's own name, fit for a path: letters, digits, spaces, dashes, brackets, one dot."""
    stem = re.sub(r"[^\w() -]+", "_", Path(name.replace("\\", "/")).stem).strip("_ ")
    return f"{stem[:60] or 'motion'}{Path(name).suffix.lower()}"


def files_router(hub: Hub) -> APIRouter:
    """`POST /api/files`; what is dropped is kept as long as the studio runs."""
    router = APIRouter(prefix="/api", tags=["studio"])
    off_thread = OffThread(hub.opening, 422)

    @router.post("/files", **answers(State, 409, 413, 415, 422))
    async def drop(name: str, request: Request) -> dict[str, Any]:
        """Body: the file's bytes; `name`: its name. Answers the state, with it as the source."""
        kind = FILES.get(Path(name).suffix.lower())
        if kind is None:
            raise refused(f"{name[:80]!r} is not a motion file: drop a .bvh or a .jsonl", 415)
        declared = request.headers.get("content-length", "")
        if declared.isdigit() and int(declared) > MAX_FILE:
            raise refused(_too_large(), 413)
        # A folder for each, so that the file keeps its name: whatever is said of it later.
        folder = hub.scratch / "dropped" / secrets.token_hex(4)
        folder.mkdir(parents=True)
        path = folder / safe_name(name)
        try:
            await _store(request, path)
            spec = f"{kind}:{path}"
            await off_thread(check, spec, name, hub.sessions)
            try:
                await hub.apply(SetSource(source=spec), request)
            except HTTPException as error:
                raise refused(in_their_words(str(error.detail), path, name)) from error
        except Unmapped:
            raise  # the file stays, for the joint map that it needs
        except BaseException:
            path.unlink(missing_ok=True)
            folder.rmdir()
            raise
        return hub.state()

    return router


class Unmapped(HTTPException):
    """422 for a file whose joints are unknown, with the `source` to ask /api/joint-map about."""

    def __init__(self, why: str, spec: str) -> None:
        super().__init__(422, detail={"why": why, "error": why, "source": spec})


def check(spec: str, name: str, sessions: Path) -> None:
    """Open the file as a source once; 422 with the reader's words (and line) if it cannot be."""
    try:
        open_source(spec, sessions=sessions).close()
    except StudioError as error:
        why = in_their_words(str(error), Path(spec.partition(":")[2]), name)
        if isinstance(error, UnmappedJoints):
            raise Unmapped(why, spec) from error
        raise refused(why, 422) from error


async def _store(request: Request, path: Path) -> None:
    size = 0
    with path.open("wb") as file:
        async for chunk in request.stream():
            size += len(chunk)
            if size > MAX_FILE:
                raise refused(_too_large(), 413)
            file.write(chunk)


def in_their_words(why: str, path: Path, name: str) -> str:
    """The same with the name that the file had where it comes from."""
    last = Path(name.replace("\\", "/")).name
    return why.replace(str(path), last).replace(path.name, last).replace(path.stem, Path(last).stem)


def _too_large() -> str:
    return f"the file is larger than {MAX_FILE // 2**20} MB: cut it into shorter clips"
