"""State and commands over HTTP: one route a command, each answered once the loop applied it."""

from typing import Any

from fastapi import APIRouter, Request
from fastapi.responses import JSONResponse
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
    Stop,
)
from studio.web.hub import Hub, refused

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


class SeekBody(BaseModel):
    """Replay: where to, playing or paused, how fast."""

    t: float | None = Field(default=None, allow_inf_nan=False)
    playing: bool | None = None
    speed: float | None = Field(default=None, allow_inf_nan=False)
    loop: bool | None = None


def commands_router(hub: Hub) -> APIRouter:
    """Everything that asks the loop for something, and what it is doing."""
    router = APIRouter(prefix="/api", tags=["studio"])

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

    @router.post("/mode")
    async def mode(body: ModeBody, request: Request) -> dict[str, Any]:
        """Idle, live, replay or collect."""
        return await answer(SetMode(mode=body.mode), request)

    @router.post("/state")
    async def state_lock(body: StateBody, request: Request) -> dict[str, Any]:
        """Lock the controller to a state, or let the selector choose (auto)."""
        return await answer(SetStateLock(state=body.state), request)

    @router.post("/source")
    async def source(body: SourceBody, request: Request) -> dict[str, Any]:
        """Where human motion comes from."""
        return await answer(SetSource(spec=body.source), request)

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

    @router.post("/reset")
    async def reset(request: Request) -> dict[str, Any]:
        """Stand up again (at most 3 s); a stop stays latched."""
        return await answer(Reset(), request)

    @router.post("/arm")
    async def arm(request: Request) -> dict[str, Any]:
        """Release a stop and follow the person, with a ramp of 1 s."""
        return await answer(Arm(), request)

    @router.post("/disarm")
    async def disarm(request: Request) -> dict[str, Any]:
        """Stop following; the robot goes to a neutral stance."""
        return await answer(Disarm(), request)

    @router.post("/gain")
    async def gain(body: GainBody, request: Request) -> dict[str, Any]:
        """A slider: tilt gain, dead zone, speed cap."""
        return await answer(SetGain(name=body.name, value=body.value), request)

    @router.post("/controller")
    async def controller(body: ControllerBody, request: Request) -> dict[str, Any]:
        """Which controller turns the reference into an action."""
        return await answer(SetController(name=body.controller), request)

    @router.post("/mirror")
    async def mirror(body: MirrorBody, request: Request) -> dict[str, Any]:
        """Move as in a mirror, or side for side."""
        return await answer(SetMirror(mirror=body.mirror), request)

    @router.post("/calibrate")
    async def calibrate(request: Request) -> dict[str, Any]:
        """Measure bone lengths and heading anew from what is seen now."""
        return await answer(Calibrate(), request)

    @router.post("/seek")
    async def seek(body: SeekBody, request: Request) -> dict[str, Any]:
        """Replay: move in the take."""
        return await answer(Seek(**body.model_dump()), request)

    @router.post("/control")
    async def control(body: ControlBody) -> dict[str, Any]:
        """A page takes, hands over or gives up control."""
        try:
            hub.desk.act(body.action, body.page, body.to)
        except StudioError as error:
            raise refused(str(error)) from error
        return hub.state()

    return router
