"""Which joint of a motion file is which: what was found by name, and what a person says of it."""

from typing import Any

from fastapi import APIRouter, Request
from pydantic import Field
from typing_extensions import TypedDict

from studio.human.joint_names import MAPPABLE, NEEDED, guess_joints
from studio.live.command import Body
from studio.live.commands import SetSource
from studio.mocap.bvh import read_joints
from studio.mocap.bvh_header import Hierarchy
from studio.mocap.joint_maps import JointMaps, joint_map_of
from studio.sources import open_source, refuse_joint_map
from studio.web.answers import State, answers
from studio.web.hub import Hub, OffThread


class JointMapBody(Body):
    """map: canonical joint to the file's joint, a list of them (their middle), or null (it has
    none); empty forgets what was said. source: bvh:FILE; the source in use if left out."""

    map: dict[str, Any] = Field(max_length=64)
    source: str | None = Field(default=None, max_length=1024)


class JointMapAnswer(TypedDict):
    """GET /api/joint-map. joints: the file's own. found: ours to the file's. missing, needed: ours.
    map: what was said by hand: the file's joints, whose middle it is; [] for none of them."""

    source: str
    joints: list[str]
    found: dict[str, list[str]]
    missing: list[str]
    needed: list[str]
    map: dict[str, list[str]]


def joint_map_router(hub: Hub) -> APIRouter:
    """GET and POST /api/joint-map."""
    router = APIRouter(prefix="/api", tags=["studio"])

    off_thread = OffThread(hub.workers, 422)

    @router.get("/joint-map", **answers(JointMapAnswer, 422))
    async def joint_map(source: str | None = None) -> dict[str, Any]:
        """The joints of a BVH as it calls them, and which is taken for which.

        joints: the file's, end sites as "J/end". found: {canonical: [file's joints]}. missing.
        needed: without these it cannot be played. map: what was said by hand.
        """
        spec = source or hub.loop.runtime.source.name
        return await off_thread(_described, hub, spec)

    @router.post("/joint-map", **answers(State, 409, 422))
    async def say(body: JointMapBody, request: Request) -> dict[str, Any]:
        """Say which joint is which; kept for every file with the same joints, and the file is made
        the source. Answers the state; 422 with why for a map with which it cannot be read."""
        spec = body.source or hub.loop.runtime.source.name
        await off_thread(_set_joint_map, hub, spec, body.map)
        await hub.apply(SetSource(source=spec), request)
        return hub.state()

    return router


def _joints(spec: str) -> Hierarchy:
    refuse_joint_map(spec)
    return read_joints(spec.partition(":")[2])


def _described(hub: Hub, spec: str) -> dict[str, Any]:
    hierarchy = _joints(spec)
    said = JointMaps(hub.sessions).of(hierarchy.names) or {}
    found = guess_joints(hierarchy.names, hierarchy.parents, said)
    return {
        "source": spec,
        "joints": hierarchy.names,
        "found": found,
        "missing": [joint for joint in MAPPABLE if joint not in found],
        "needed": NEEDED,
        "map": said,
    }


def _set_joint_map(hub: Hub, spec: str, said: dict[str, Any]) -> None:
    joints = _joints(spec)
    if not said:
        JointMaps(hub.sessions).remember(joints.names, {})
    open_source(spec, sessions=hub.sessions, joint_map=joint_map_of(said)).close()
