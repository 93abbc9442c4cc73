"""Training mappers over HTTP: start, watch, cancel, list."""

from datetime import datetime
from typing import Any, Literal

from fastapi import APIRouter
from pydantic import Field, StrictBool, StrictInt

from studio.errors import StudioError, unknown_name
from studio.live.command import Body
from studio.live.mappers import list_mappers, list_rivals, mapper_folder
from studio.options import STYLES
from studio.reference.intent import STATES
from studio.takes.as_json import plain
from studio.takes.dataset import datasets
from studio.takes.dataset.known_counts import KnownCounts
from studio.takes.session_library import SessionLibrary
from studio.training.enough import left_out
from studio.training.rivals import refuse_taken
from studio.web.answers import answers
from studio.web.answers_takes import DataSet, PairCounts, Rival, TrainedMapper, Training
from studio.web.hub import Hub, OffThread
from studio.web.train_jobs import TrainJobs


class FromBody(Body):
    """Which takes to learn from, or which data set version, and the style of walking."""

    takes: list[str] = Field(default=[], max_length=10_000)
    dataset: str | None = Field(default=None, max_length=120)
    style: str = "march"


class TrainBody(FromBody):
    """Which states to train as well. start: go on from the shipped experts, or from scratch."""

    states: list[str] = Field(default=list(STATES), min_length=1)
    name: str | None = Field(default=None, max_length=120)
    start: Literal["shipped", "scratch"] = "shipped"
    mirror: StrictBool = True
    steps: StrictInt = Field(default=0, ge=0, le=100_000)


def train_router(hub: Hub) -> APIRouter:
    """`/api/train`, `/api/mappers` and `/api/rivals`."""
    router = APIRouter(prefix="/api", tags=["train"])
    jobs = TrainJobs(hub.sessions, hub.scratch)
    hub.at_close.append(jobs.close)
    library = SessionLibrary(hub.sessions)
    known = KnownCounts(library)

    off_thread = OffThread(hub.workers, 409)

    def checked(body: TrainBody) -> tuple[str, list[str]]:
        for take in body.takes:
            library.folder(take)
        for state in body.states:
            if state not in STATES:
                raise StudioError(f"unknown state {state!r}; known: {', '.join(STATES)}")
        if body.style not in STYLES:
            raise StudioError(f"unknown style {body.style!r}; known: {', '.join(STYLES)}")
        name = body.name or f"mine-{datetime.now():%Y%m%d-%H%M%S}"
        refuse_taken(name)
        if mapper_folder(hub.sessions, name).exists():
            raise StudioError(f"a mapper named {name} exists: choose another name")
        if body.dataset is not None:
            datasets.load(hub.sessions, body.dataset)
            source = ["--dataset", body.dataset]
        elif body.takes:
            source = ["--takes", *body.takes]
        else:
            raise StudioError("choose takes to learn from, or a data set version")
        options = [*source, "--states", *body.states, "--style", body.style]
        options += ["--start", body.start, "--steps", str(body.steps)]
        return name, [*options, "--mirror" if body.mirror else "--no-mirror"]

    def counted(body: FromBody) -> dict[str, Any]:
        if body.dataset is None:
            takes = {name: known.of(name) for name in body.takes}
        else:
            made = {m["version"]: m for m in datasets.versions(hub.sessions)}
            if body.dataset not in made:
                raise unknown_name("data set version", body.dataset, made)
            takes = {row["name"]: row["by_state"] for row in made[body.dataset]["takes"]}
        by_state = {s: {name: counts[s] for name, counts in takes.items()} for s in STATES}
        return {
            "counts": {s: sum(of.values()) for s, of in by_state.items()},
            "left_out": left_out(by_state, STATES, body.style),
        }

    @router.post("/train/pairs", **answers(PairCounts, 422))
    async def pairs(body: FromBody) -> dict[str, Any]:
        """How many pairs there are of each state, and of which there are too few: before a
        training. A lag that is only proposed may take some away at a take's ends."""
        return await off_thread(lambda: counted(body), status=422)

    @router.post("/train", **answers(Training, 409, 422))
    async def train(body: TrainBody) -> dict[str, Any]:
        """Train a mapper in a process of its own; watch it with GET."""
        name, options = await off_thread(lambda: checked(body), status=422)
        return plain((await off_thread(lambda: jobs.start(name, options))).as_dict())

    @router.get("/train", **answers(Training | None, 409))
    async def progress() -> dict[str, Any] | None:
        """The last training: status, curves, held-out scores; null before the first."""
        job = jobs.job
        return None if job is None else plain(await off_thread(job.as_dict))

    @router.post("/train/cancel", **answers(Training, 409))
    async def cancel() -> dict[str, Any]:
        """End it; nothing is kept of it."""
        return plain((await off_thread(jobs.cancel)).as_dict())

    @router.get("/datasets", **answers(list[DataSet], 409))
    async def data_sets() -> list[dict[str, Any]]:
        """Every data set version: what it was made from, and how many pairs it holds."""
        found = await off_thread(lambda: datasets.versions(hub.sessions))
        return plain([{k: v for k, v in m.items() if k != "statistics"} for m in found])

    @router.get("/mappers", **answers(list[TrainedMapper], 409))
    async def mappers() -> list[dict[str, Any]]:
        """Every mapper trained here, with its data, settings and scores."""
        return plain(await off_thread(lambda: list_mappers(hub.sessions)))

    @router.get("/rivals", **answers(list[Rival], 409))
    async def rivals() -> list[dict[str, str]]:
        """What the mapper is compared with, those of the paper among them: `POST /api/mapper` takes
        their names."""
        return await off_thread(lambda: list_rivals(hub.sessions))

    return router
