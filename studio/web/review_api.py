"""Reviewing takes over HTTP: curves, what was found, alignment, split and bin."""

from typing import Any

import numpy as np
from fastapi import APIRouter
from pydantic import Field, StrictBool, StrictInt

from studio.live.command import Body, Number
from studio.takes.align import synchrony
from studio.takes.as_json import plain
from studio.takes.edit import edited, review, windows
from studio.takes.series import series
from studio.takes.session_library import SessionLibrary
from studio.timing import CONTROL_HZ
from studio.web.answers import answers
from studio.web.answers_takes import Aligned, Series, Split, TakeInfo, Timeline
from studio.web.hub import Hub, OffThread, refused


class AlignBody(Body):
    """accept the proposed lag (with a time warp on top, if warp), or refuse it."""

    accept: StrictBool = True
    warp: StrictBool = False


class CleanBody(Body):
    """Which suggestions to cut out, by their index in the review; all of them without."""

    which: list[StrictInt] | None = Field(default=None, max_length=10_000)


class SplitBody(Body):
    """Where, s into the take."""

    at: Number


def review_router(hub: Hub) -> APIRouter:
    """`/api/takes/{name}/…` and the bin. Comes before `takes_router`, whose paths are wider."""
    router = APIRouter(prefix="/api/takes", tags=["review"])
    library = SessionLibrary(hub.sessions)

    off_thread = OffThread(hub.workers, 422)

    async def known(name: str) -> None:
        await off_thread(lambda: library.folder(name), status=404)

    def drawable(points: int) -> None:
        if not 2 <= points <= 4000:
            raise refused("points are between 2 and 4000", 422)

    async def info(name: str) -> dict[str, Any]:
        return (await off_thread(lambda: library.info(name), status=404)).as_dict()

    @router.get("/deleted")
    async def deleted() -> list[str]:
        """Names in the bin."""
        return await off_thread(library.deleted, status=500)

    @router.post("/{name}/restore", **answers(TakeInfo, 404))
    async def restore(name: str) -> dict[str, Any]:
        """Back from the bin."""
        return (await off_thread(lambda: library.restore(name), status=404)).as_dict()

    @router.get("/{name}/review", **answers(review.Review, 404, 422))
    async def reviewed(name: str) -> dict[str, Any]:
        """Suggestions, alignment as it is and as proposed, score and why."""
        await known(name)
        return plain((await off_thread(lambda: review.review(library, name))).as_dict())

    @router.get("/{name}/timeline", **answers(Timeline, 404, 422))
    async def timeline(name: str, points: int = 600, aligned: bool = True) -> dict[str, Any]:
        """Curves of both sides over the whole take: tilt, height, hands and paws, steps."""
        await known(name)
        drawable(points)

        def work() -> dict[str, Any]:
            table, edits = edited.open_table(hub.sessions, name)
            if not aligned:
                edits = type(edits)(trim=edits.trim, cuts=edits.cuts)
            curves = windows.overview(table, edits, points)
            ticks = np.rint(np.asarray(curves["t"]) * CONTROL_HZ).astype(int)
            contact = np.asarray(table.rows["reference_foot_contact"][ticks], dtype=np.float64)
            return {**curves, "seconds": table.seconds, "contact": contact}

        return plain(await off_thread(work))

    @router.get("/{name}/series", **answers(Series, 404, 422))
    async def signals(name: str, points: int = 2000) -> dict[str, Any]:
        """Speed, turn, tilt, height, paws, joint error and lag over the whole take, for plots."""
        await known(name)
        drawable(points)

        def work() -> dict[str, Any]:
            table, _ = edited.open_table(hub.sessions, name)
            values = series(table, points)
            return {
                "t_s": values.pop("t_s"),
                "signals": values,
                "seconds": table.seconds,
                "ticks": len(table),
                "problem": table.problem,
            }

        return plain(await off_thread(work), digits=4)

    @router.post("/{name}/align", **answers(Aligned, 404, 422))
    async def align(name: str, body: AlignBody) -> dict[str, Any]:
        """Accept or refuse the proposed alignment: an edit, which undo takes back."""
        await known(name)
        if body.accept:
            work = lambda: synchrony.accept_alignment(library, name, warp=body.warp)  # noqa: E731
            before, found = await off_thread(work)
            changed = {"before": before, "after": found}
        else:
            await off_thread(lambda: synchrony.refuse_alignment(library, name))
            changed = {}
        return {**await info(name), **plain({k: vars(v) for k, v in changed.items() if v})}

    @router.post("/{name}/clean", **answers(TakeInfo, 404, 422))
    async def clean(name: str, body: CleanBody | None = None) -> dict[str, Any]:
        """Cut suggestions out: an edit, which undo takes back."""
        await known(name)
        which = None if body is None else body.which
        await off_thread(lambda: review.accept_suggestions(library, name, which))
        return await info(name)

    @router.post("/{name}/split", **answers(Split, 404, 422))
    async def split(name: str, body: SplitBody) -> dict[str, Any]:
        """One take into two of the same tape; undo joins them."""
        await known(name)
        first, second = await off_thread(lambda: library.split(name, body.at))
        return {"takes": [first.as_dict(), second.as_dict()]}

    return router
