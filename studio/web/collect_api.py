"""What there is to collect and what was collected, over HTTP (plans: `live.commands.collect`)."""

import asyncio
from typing import Any

from fastapi import APIRouter
from pydantic import Field

from studio.live.command import Body
from studio.live.shown_motion import PROMPTS
from studio.reference.library import TASKS
from studio.takes.as_json import plain
from studio.takes.dataset.datamap import DataMap
from studio.takes.sessions import SessionBook
from studio.web.answers import answers
from studio.web.answers_takes import CollectSession, CoverageMap, Task
from studio.web.hub import Hub, OffThread


class NotesBody(Body):
    """A session's notes."""

    notes: str = Field(max_length=4000)


def collect_router(hub: Hub) -> APIRouter:
    """`/api/collect`."""
    router = APIRouter(prefix="/api/collect", tags=["collect"])
    book = SessionBook(hub.sessions)
    data, looking = DataMap(hub.sessions), asyncio.Lock()

    off_thread = OffThread(hub.workers, 404)

    @router.get("/tasks", **answers(list[Task]))
    async def tasks() -> list[dict[str, str]]:
        """What can be collected: task, state, and what the person is told."""
        return [
            {"task": name, "state": task.state, "prompt": PROMPTS.get(name, "")}
            for name, task in TASKS.items()
        ]

    @router.get("/map", **answers(CoverageMap))
    async def map_of_data() -> dict[str, Any]:
        """What the takes cover by state and range, and what to record next."""
        async with looking:
            return plain(await off_thread(data.as_dict, status=500))

    @router.get("/sessions", **answers(list[CollectSession]))
    async def sessions() -> list[dict[str, Any]]:
        """Takes by operator and day, newest first, with notes and calibration."""
        return [s.as_dict() for s in await off_thread(book.list)]

    @router.get("/sessions/{name}", **answers(CollectSession, 404))
    async def session(name: str) -> dict[str, Any]:
        """One session."""
        return (await off_thread(book.read, name)).as_dict()

    @router.patch("/sessions/{name}", **answers(CollectSession, 404, 422))
    async def note(name: str, body: NotesBody) -> dict[str, Any]:
        """Write a session's notes."""
        return (await off_thread(book.note, name, body.notes)).as_dict()

    return router
