"""The library of takes over HTTP: many at once, their pictures and scores, the bin."""

from collections import OrderedDict
from collections.abc import Callable, Sequence
from dataclasses import asdict
from typing import Any, Literal, TypeVar

from fastapi import APIRouter
from pydantic import Field

from studio.errors import StudioError
from studio.live.command import Body
from studio.takes import bin, many, thumbnail
from studio.takes.many import Action
from studio.web.answers import answers
from studio.web.answers_takes import Acted, Bin, Pictures, Scores
from studio.web.hub import Hub, OffThread, refused

T = TypeVar("T")
FEW = 50
"""Takes that are dealt with here; more go to a process of its own, for they hold Python up."""
LOOKED_AT = 24
"""Takes at once whose tapes are looked into: what a page shows, and an answer within seconds."""
REMEMBERED = 2000
"""Pictures: some four megabytes."""


class ManyBody(Body):
    """Which takes, and what becomes of them: a verdict, or the bin."""

    names: list[str] = Field(min_length=1, max_length=10_000)
    action: Action


class BinBody(Body):
    """Which places of the bin; delete: for good."""

    places: list[str] = Field(min_length=1, max_length=10_000)
    action: Literal["restore", "delete"]


class LookBody(Body):
    """Which takes to look at."""

    names: list[str] = Field(min_length=1, max_length=LOOKED_AT)


async def elsewhere(hub: Hub, work: Callable[..., T], *args: Any) -> T:
    """`work(sessions, *args)` in a process of its own; 500 where that was killed."""
    try:
        return await hub.worker_process.run(work, hub.sessions, *args)
    except StudioError as error:
        raise refused(str(error), 500) from error


class Thumbnails:
    """Pictures, remembered for as long as tape and edits stay as they are. One event loop."""

    def __init__(self, hub: Hub) -> None:
        self._hub = hub
        self._known: OrderedDict[str, tuple[tuple[int, ...], str]] = OrderedDict()

    async def of(self, names: Sequence[str]) -> Pictures:
        """Those of takes, and of places in the bin; drawn now where they are not known."""
        off_thread = OffThread(self._hub.workers, 500)
        keys, why = await off_thread(self._keys, names)
        known = {name: self._known.get(name, ((), "")) for name in keys}
        new = [name for name, (key, _) in known.items() if key != keys[name]]
        pictures = {name: picture for name, (key, picture) in known.items() if key == keys[name]}
        if new:
            drawn, undrawn = await elsewhere(self._hub, thumbnail.thumbnails, new)
            why |= undrawn
            pictures |= drawn
            self._known |= {name: (keys[name], picture) for name, picture in drawn.items()}
        for name in pictures:
            self._known.move_to_end(name)
        while len(self._known) > REMEMBERED:
            self._known.popitem(last=False)
        return {"pictures": pictures, "refused": why}

    def _keys(self, names: Sequence[str]) -> tuple[dict[str, tuple[int, ...]], dict[str, str]]:
        keys, why = {}, {}
        for name in names:
            try:
                keys[name] = thumbnail.key_of(thumbnail.folder_of(self._hub.sessions, name))
            except StudioError as error:
                why[name] = str(error)
        return keys, why


def library_router(hub: Hub) -> APIRouter:
    """`/api/takes/many`, `/thumbnails`, `/scores`, and `/api/bin`."""
    router = APIRouter(prefix="/api", tags=["takes"])
    thumbnails = Thumbnails(hub)
    off_thread = OffThread(hub.workers, 500)

    @router.post("/takes/many", **answers(Acted, 422))
    async def act(body: ManyBody) -> dict[str, Any]:
        """Keep, reject, leave undecided or delete takes; each for itself, the refused with why."""
        if len(body.names) <= FEW:
            return asdict(await off_thread(many.act, hub.sessions, body.names, body.action))
        return asdict(await elsewhere(hub, many.act, body.names, body.action))

    @router.post("/takes/thumbnails", **answers(Pictures, 422))
    async def pictures(body: LookBody) -> Pictures:
        """A small picture of each take, as SVG; of one in the bin by its place there."""
        return await thumbnails.of(body.names)

    @router.post("/takes/scores", **answers(Scores, 422))
    async def scores(body: LookBody) -> dict[str, Any]:
        """Each take's score; those that have none are looked over and given one."""
        found, why = await elsewhere(hub, many.scores, body.names)
        return {"scores": found, "refused": why}

    @router.get("/bin", **answers(Bin))
    async def thrown_away() -> dict[str, Any]:
        """What was deleted, and the space that it takes."""
        found = await off_thread(bin.contents, hub.sessions)
        return {
            "bytes": sum(one.bytes for one in found),
            "takes": [{**vars(one), "take": one.take.as_dict()} for one in reversed(found)],
        }

    @router.post("/bin", **answers(Acted, 422))
    async def act_in_bin(body: BinBody) -> dict[str, Any]:
        """Bring takes back from the bin, or delete them for good."""
        return asdict(await off_thread(many.act_in_bin, hub.sessions, body.places, body.action))

    return router
