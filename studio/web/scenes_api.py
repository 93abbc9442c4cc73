"""Scenes over HTTP: what there is to do in each, what stands in it, who did it best."""

from typing import Any

import numpy as np
from fastapi import APIRouter
from typing_extensions import TypedDict

from studio.live.best_runs import BestRun, BestRuns
from studio.options import SCENES, SceneName
from studio.scenes.registry import scene as scene_of
from studio.scenes.scene import Scene
from studio.sim.props import PropShape
from studio.web.answers import answers
from studio.web.hub import Hub, OffThread


class SceneStep(TypedDict):
    """goal: what the robot has to do; body: what whoever drives does for it."""

    goal: str
    body: str


class PropPlan(TypedDict):
    """A prop from above, as declared: its middle (m), heading (rad), and half its size ahead and to
    the left (m). color: sRGB of 0 to 255. moves: it may be elsewhere (`props` of the state)."""

    name: str
    round: bool
    x: float
    y: float
    yaw: float
    half: list[float]
    color: list[int]
    moves: bool


class SceneInfo(TypedDict):
    """A scene. best: each person's best run, the best first."""

    name: SceneName
    title: str
    about: str
    steps: list[SceneStep]
    props: list[PropPlan]
    best: list[BestRun]


class Scenes(TypedDict):
    """All there are."""

    scenes: list[SceneInfo]


def scenes_router(hub: Hub) -> APIRouter:
    """`GET /api/scenes`."""
    router = APIRouter(prefix="/api", tags=["studio"])
    best, off_thread = BestRuns(hub.sessions), OffThread(hub.workers, 409)
    known = [scene_of(name) for name in SCENES if name != "empty"]

    def all_of_them() -> dict[str, Any]:
        return {"scenes": [info(scene, best.of(scene.name)) for scene in known]}

    @router.get("/scenes", **answers(Scenes))
    async def scenes() -> dict[str, Any]:
        """What there is to do, and who did it best."""
        return await off_thread(all_of_them)

    return router


def info(scene: Scene, best: list[BestRun]) -> SceneInfo:
    """What the page is told of a scene."""
    return SceneInfo(
        name=scene.name,  # type: ignore[typeddict-item]
        title=scene.title,
        about=scene.about,
        steps=[SceneStep(goal=step.goal, body=step.body) for step in scene.steps],
        props=[plan(prop) for prop in scene.props],
        best=best,
    )


def plan(prop: PropShape) -> PropPlan:
    """A prop from above."""
    half = prop.size[:2] if prop.kind == "box" else (prop.size[0],) * 2
    return PropPlan(
        name=prop.name,
        round=prop.kind != "box",
        x=round(prop.pos[0], 3),
        y=round(prop.pos[1], 3),
        yaw=round(prop.rpy[2], 4),
        half=[round(h, 4) for h in half],
        color=np.round(255.0 * np.array(prop.color)).astype(int).tolist(),
        moves=prop.bodied,
    )
