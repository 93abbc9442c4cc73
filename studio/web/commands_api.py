"""State and commands over HTTP: one route a command, each answered once the loop applied it."""

from collections.abc import Callable, Coroutine
from typing import Any

from fastapi import APIRouter, HTTPException, Request, Response
from fastapi.exceptions import RequestValidationError
from fastapi.responses import JSONResponse
from fastapi.routing import APIRoute
from pydantic import BaseModel, Field

import studio
from studio.errors import StudioError
from studio.live.commands import (
    Arm,
    Calibrate,
    Command,
    Disarm,
    Reset,
    Seek,
    SetController,
    SetGain,
    SetMirror,
    SetMode,
    SetSource,
    SetStateLock,
    SetStyle,
    Stop,
)
from studio.web.hub import Hub, misfit, refused

SCENES = ("empty",)
"""Scenes with props come with the composite tasks; until then there is the bare floor."""


class ModeBody(BaseModel):
    """idle | live | replay | collect."""

    mode: str


class StateBody(BaseModel):
    """auto | stand | walk | sit."""

    state: str


class SourceBody(BaseModel):
    """operator[:TASK], bvh:FILE, frames:FILE, take:NAME, stream …"""

    source: str = Field(max_length=1024)


class SceneBody(BaseModel):
    """A scene's name."""

    scene: str = Field(max_length=64)


class ControlBody(BaseModel):
    """take, release or hand_over (to another page)."""

    page: str = Field(max_length=64)
    action: str = "take"
    to: str | None = Field(default=None, max_length=64)


class GainBody(BaseModel):
    """One of the operator's sliders."""

    name: str = Field(max_length=64)
    value: float = Field(allow_inf_nan=False)


class ControllerBody(BaseModel):
    """stand_still | pd_playback | policy."""

    controller: str = Field(max_length=64)


class MirrorBody(BaseModel):
    """Whether the robot moves as a mirror image would."""

    mirror: bool


class StyleBody(BaseModel):
    """march | circles | semantic."""

    style: str = Field(max_length=64)


class SeekBody(BaseModel):
    """Replay: where to, playing or paused, how fast."""

    t: float | None = Field(default=None, allow_inf_nan=False)
    playing: bool | None = None
    speed: float | None = Field(default=None, allow_inf_nan=False)
    loop: bool | None = None


class CommandRoute(APIRoute):
    """A command that is not applied is answered 409 with `why`, one that does not fit included."""

    def get_route_handler(self) -> Callable[[Request], Coroutine[Any, Any, Response]]:
        """FastAPI's own, with its refusal turned into ours."""
        handler = super().get_route_handler()

        async def handled(request: Request) -> Response:
            try:
                return await handler(request)
            except RequestValidationError as error:
                raise refused(misfit(error)) from error
            except HTTPException as error:
                if error.status_code != 400:
                    raise
                raise refused("the body is no JSON in UTF-8") from error

        return handled


Make = Callable[[Any], Command]
COMMANDS: dict[str, tuple[str, type[BaseModel] | None, Make]] = {
    "mode": ("Idle, live, replay or collect.", ModeBody, lambda b: SetMode(mode=b.mode)),
    "state": (
        "Lock the controller to a state, or let the selector choose (auto).",
        StateBody,
        lambda b: SetStateLock(state=b.state),
    ),
    "source": ("Where human motion comes from.", SourceBody, lambda b: SetSource(spec=b.source)),
    "reset": ("Stand up again (at most 3 s); a stop stays latched.", None, lambda _: Reset()),
    "arm": ("Release a stop and follow the person, with a ramp of 1 s.", None, lambda _: Arm()),
    "disarm": ("Stop following; the robot goes to a neutral stance.", None, lambda _: Disarm()),
    "gain": (
        "A slider: tilt gain, dead zone, speed cap.",
        GainBody,
        lambda b: SetGain(name=b.name, value=b.value),
    ),
    "controller": (
        "Which controller turns the reference into an action.",
        ControllerBody,
        lambda b: SetController(name=b.controller),
    ),
    "mirror": (
        "Move as in a mirror, or side for side.",
        MirrorBody,
        lambda b: SetMirror(mirror=b.mirror),
    ),
    "style": (
        "Which human motion means walking, from now on; the built-in operator follows.",
        StyleBody,
        lambda b: SetStyle(style=b.style),
    ),
    "calibrate": (
        "Measure bone lengths and heading anew from what is seen now.",
        None,
        lambda _: Calibrate(),
    ),
    "seek": ("Replay: move in the take.", SeekBody, lambda b: Seek(**b.model_dump())),
}
"""POST /api/NAME: what it does, the body it takes, and the command that it becomes."""


def commands_router(hub: Hub) -> APIRouter:
    """Everything that asks the loop for something, and what it is doing."""
    refusals: dict[int | str, dict[str, Any]] = {
        409: {"description": "not applied; `why` says why"}
    }
    router = APIRouter(prefix="/api", tags=["studio"], route_class=CommandRoute, responses=refusals)

    async def answer(command: Command, request: Request) -> dict[str, Any]:
        await hub.apply(command, request)
        return hub.state()

    @router.get("/health")
    async def health() -> Any:
        """Open to all: whether the loop ticks, and the version."""
        if hub.loop.ticks.get() is None:
            return JSONResponse({"status": "starting", "version": studio.__version__}, 503)
        return {"status": "ok", "version": studio.__version__}

    @router.get("/state")
    async def state() -> dict[str, Any]:
        """What the studio is doing, and why nothing moves if nothing does."""
        return hub.state()

    for name, (about, body, make) in COMMANDS.items():
        router.post(f"/{name}", name=name, description=about)(_route(answer, body, make))

    @router.post("/scene")
    async def scene(body: SceneBody) -> dict[str, Any]:
        """What stands around the robot."""
        if body.scene not in SCENES:
            raise refused(f"unknown scene {body.scene!r}; known: {', '.join(SCENES)}")
        return hub.state()

    @router.post("/stop")
    async def stop(request: Request) -> dict[str, Any]:
        """Emergency stop: damping until a reset; latched until armed. Anybody may."""
        return await answer(Stop(by=request.headers.get("x-studio-page", "api")), request)

    @router.post("/control")
    async def control(body: ControlBody) -> dict[str, Any]:
        """A page takes, hands over or gives up control."""
        try:
            hub.desk.act(body.action, body.page, body.to)
        except StudioError as error:
            raise refused(str(error)) from error
        return hub.state()

    return router


Answer = Callable[[Command, Request], Coroutine[Any, Any, dict[str, Any]]]


def _route(answer: Answer, body: type[BaseModel] | None, make: Make) -> Callable[..., Any]:
    """The function that FastAPI calls: its annotations say which body to expect."""
    if body is None:

        async def bare(request: Request) -> dict[str, Any]:
            return await answer(make(None), request)

        return bare

    async def with_body(body: Any, request: Request) -> dict[str, Any]:
        return await answer(make(body), request)

    with_body.__annotations__["body"] = body
    return with_body
