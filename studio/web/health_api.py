"""GET /api/health, open to all: whether the studio works, and what does not."""

from typing import Literal, NotRequired

from fastapi import APIRouter
from fastapi.responses import JSONResponse
from typing_extensions import TypedDict

import studio
from studio.web.answers import answers
from studio.web.hub import Hub


class Health(TypedDict):
    """why: what is not as it should be, where it is degraded."""

    status: Literal["ok", "starting", "degraded"]
    version: str
    why: NotRequired[str]


HEALTH = answers(Health)
HEALTH["responses"][503] = {"model": Health, "description": "the robot cannot be driven"}


def health_router(hub: Hub) -> APIRouter:
    """What a supervisor asks, and what a page asks before it has a token."""
    router = APIRouter(prefix="/api", tags=["studio"])

    @router.get("/health", **HEALTH)
    async def health() -> JSONResponse:
        """ok; degraded, with `why`: it works but for that, or (503) the robot cannot be driven."""
        grave, minor = hub.supervisor.troubles()
        status = "starting" if grave == ["starting"] else "degraded" if grave or minor else "ok"
        body: Health = {"status": status, "version": studio.__version__}
        if status == "degraded":
            body["why"] = "; ".join((*grave, *minor))
        return JSONResponse(body, 503 if grave else 200)

    return router
