"""Collecting over HTTP: make a plan, act, and look at sessions; the loop does the rest."""

import asyncio
import secrets
from typing import Any

from fastapi import APIRouter, Request
from pydantic import BaseModel, ConfigDict, Field

from studio.errors import StudioError
from studio.live.collect import CollectPlan
from studio.live.commands import AddToPlan, CollectAction, SetPlan
from studio.live.shown import PROMPTS, PlanItem
from studio.reference.library import TASKS
from studio.takes.dataset.datamap import DataMap
from studio.takes.sessions import SessionBook
from studio.web.encode import plain
from studio.web.hub import Hub, refused


class ItemBody(BaseModel):
    """A task, how often, and how long each motion is (s, without the rests)."""

    model_config = ConfigDict(extra="forbid")
    task: str = Field(max_length=64)
    takes: int = 3
    seconds: float = Field(default=8.0, allow_inf_nan=False)
    difficulty: float = Field(default=0.7, allow_inf_nan=False)

    def item(self) -> PlanItem:
        """Checked; 422 says what would work."""
        try:
            return PlanItem(**self.model_dump()).checked()
        except StudioError as error:
            raise refused(str(error), 422) from error


class PlanBody(BaseModel):
    """What to collect, from whom. seed: of the motions; a new one if left out."""

    model_config = ConfigDict(extra="forbid")
    items: list[ItemBody] = Field(min_length=1, max_length=40)
    operator: str = Field(default="me", min_length=1, max_length=60)
    notes: str = Field(default="", max_length=4000)
    preview: bool = True
    hands_free: bool = False
    seed: int | None = Field(default=None, ge=0)


class AddBody(BaseModel):
    """More to collect, after what is planned."""

    model_config = ConfigDict(extra="forbid")
    items: list[ItemBody] = Field(min_length=1, max_length=40)


class ActionBody(BaseModel):
    """go | skip | keep | redo | next | abort."""

    action: str = Field(max_length=16)


class NotesBody(BaseModel):
    """A session's notes."""

    notes: str = Field(max_length=4000)


MAX_PLAN = 200
"""Takes in one plan: each is drawn ahead, some 0.2 s of work."""


def collect_router(hub: Hub) -> APIRouter:
    """`/api/collect`."""
    router = APIRouter(prefix="/api/collect", tags=["collect"])
    book = SessionBook(hub.sessions)
    data, looking = DataMap(hub.sessions), asyncio.Lock()

    async def off_thread(work: Any, *args: Any, status: int = 404) -> Any:
        try:
            return await asyncio.get_running_loop().run_in_executor(hub.workers, work, *args)
        except StudioError as error:
            raise refused(str(error), status) from error

    def items_of(bodies: list[ItemBody]) -> tuple[PlanItem, ...]:
        items = tuple(body.item() for body in bodies)
        if sum(item.takes for item in items) > MAX_PLAN:
            raise refused(f"a plan holds at most {MAX_PLAN} takes: collect in several rounds", 422)
        return items

    @router.get("/tasks")
    async def tasks() -> list[dict[str, str]]:
        """What can be collected: task, state, and what the person is told."""
        return [
            {"task": name, "state": task.state, "prompt": PROMPTS.get(name, "")}
            for name, task in TASKS.items()
        ]

    @router.post("/plan")
    async def plan(body: PlanBody, request: Request) -> dict[str, Any]:
        """Choose what to collect; mode collect follows it. Answers the state."""
        items = items_of(body.items)
        seed = secrets.randbelow(2**31) if body.seed is None else body.seed
        options = body.model_dump(exclude={"items", "seed"})
        await hub.apply(SetPlan(plan=CollectPlan(items=items, seed=seed, **options)), request)
        return hub.state()

    @router.post("/add")
    async def add(body: AddBody, request: Request) -> dict[str, Any]:
        """Put more at the end of the plan."""
        await hub.apply(AddToPlan(items=items_of(body.items)), request)
        return hub.state()

    @router.post("/action")
    async def action(body: ActionBody, request: Request) -> dict[str, Any]:
        """Go, skip the preview, keep, redo, next, abort. Answers the state and, under `judged`,
        which take was kept or rejected."""
        result = await hub.apply(CollectAction(action=body.action), request)
        return {**hub.state(), "judged": result.data or None}

    @router.get("/map")
    async def map_of_data() -> dict[str, Any]:
        """What the takes cover by state and range, and what to record next."""
        async with looking:
            return plain(await off_thread(data.as_dict, status=500))

    @router.get("/sessions")
    async def sessions() -> list[dict[str, Any]]:
        """Takes by operator and day, newest first, with notes and calibration."""
        return [s.as_dict() for s in await off_thread(book.list)]

    @router.get("/sessions/{name}")
    async def session(name: str) -> dict[str, Any]:
        """One session."""
        return (await off_thread(book.read, name)).as_dict()

    @router.patch("/sessions/{name}")
    async def note(name: str, body: NotesBody) -> dict[str, Any]:
        """Write a session's notes."""
        return (await off_thread(book.note, name, body.notes)).as_dict()

    return router
