"""The props of a scene in the view: made when the scene changes, sent again only where they move.

They lie in the simulated robot's world (`scene.World`), which the view shifts to its place.
"""

from collections.abc import Sequence

import numpy as np
import viser
from numpy.typing import NDArray

from studio import geometry
from studio.scenes.scene import Scene
from studio.sim.prop_world import PropPoses
from studio.sim.props import PropShape
from studio.web import shapes
from studio.web.scene_batch import Batch

Array = NDArray[np.float64]
Parts = list[tuple[PropShape, tuple[float, ...], float]]
"""Prop, size and height above its centre of each of its parts."""
STRING_RADIUS = 0.004
STRING_COLOR = (150, 150, 150)
ROOT = "/robot/world/props"


class Group:
    """All parts of one mesh, of props that move or of props that do not."""

    def __init__(self, scene: viser.SceneApi, name: str, mesh: shapes.Mesh, parts: Parts) -> None:
        self._props = [prop for prop, _, _ in parts]
        self._up = np.array([[0.0, 0.0, up] for _, _, up in parts])
        color = 255.0 * np.array([prop.color for prop in self._props])
        scales = np.array([_scale(prop, size) for prop, size, _ in parts])
        flat = all(prop.held == "drawn" for prop in self._props)
        self._batch = Batch(scene, name, mesh, len(parts), color, scales=scales, shadow=not flat)

    def rest(self) -> None:
        """To where they were declared, for good."""
        at = np.array([prop.pos for prop in self._props])
        self._move(at, geometry.quat_from_rpy(np.array([prop.rpy for prop in self._props])))

    def follow(self, index: dict[str, int], poses: PropPoses) -> None:
        """To where the bodies are; index: of each prop, in `poses`."""
        rows = [index[prop.name] for prop in self._props]
        self._move(poses.pos[rows], poses.quat[rows])

    def _move(self, pos: Array, quat: Array) -> None:
        self._batch.move(pos + geometry.quat_rotate(quat, self._up), quat)


class Props:
    """What is drawn of a scene's props. One thread calls `update`."""

    def __init__(self, scene: viser.SceneApi) -> None:
        self._scene = scene
        self._shown: Scene | None = None
        self._poses: PropPoses | None = None

    def update(self, shown: tuple[Scene, PropPoses] | None) -> None:
        """Draw these props, or none."""
        scene = None if shown is None else shown[0]
        if scene is not self._shown:
            self._set(scene)
        if shown is None:
            return
        poses, before = shown[1], self._poses
        if before is not None and np.array_equal(before.pos, poses.pos):
            return
        self._poses = poses
        for group in self._moving:
            group.follow(self._index, poses)
        self._pull_strings(poses)

    def _set(self, scene: Scene | None) -> None:
        self._scene.remove_by_name(ROOT)
        self._shown, self._poses = scene, None
        if scene is None:
            return
        self._scene.add_frame(ROOT, show_axes=False)
        self._index = {prop.name: k for k, prop in enumerate(scene.bodied)}
        still = [prop for prop in scene.props if not prop.bodied]
        for group in self._groups("still", still):
            group.rest()
        self._moving = self._groups("moving", scene.bodied)
        hung = [prop for prop in scene.bodied if prop.held == "hung"]
        self._hung = [self._index[prop.name] for prop in hung]
        self._ties = np.array([[0.0, 0.0, prop.size[-1]] for prop in hung])
        if hung:
            mesh, n = shapes.rod_mesh(), len(hung)
            self._strings = Batch(
                self._scene, f"{ROOT}/strings", mesh, n, STRING_COLOR, scaled=True, shadow=False
            )

    def _groups(self, what: str, props: Sequence[PropShape]) -> list[Group]:
        """One for each mesh, of which each part is an instance."""
        parts: dict[tuple, Parts] = {}
        for prop in props:
            # What is flat casts no shadow; a capsule cannot be stretched to another's size.
            key = (prop.kind, prop.held == "drawn", prop.size if prop.kind == "capsule" else ())
            parts.setdefault(key, []).extend((prop, size, up) for size, up in prop.parts())
        return [
            Group(self._scene, f"{ROOT}/{what}_{k}", _mesh(rows[0][0]), rows)
            for k, rows in enumerate(parts.values())
        ]

    def _pull_strings(self, poses: PropPoses) -> None:
        if not self._hung:
            return
        top = poses.hooks[self._hung]
        tie = poses.pos[self._hung] + geometry.quat_rotate(poses.quat[self._hung], self._ties)
        along = top - tie
        length = np.linalg.norm(along, axis=-1, keepdims=True)
        thin = np.full((len(top), 2), STRING_RADIUS)
        self._strings.move(tie, shapes.quat_along(along), np.hstack([thin, length]))


def _mesh(prop: PropShape) -> shapes.Mesh:
    """A unit shape of its kind: half edges, radius and half length of 1 m; a capsule as it is."""
    if prop.kind == "capsule":
        return shapes.capsule_mesh(*prop.size)
    made = {"box": shapes.box_mesh, "ball": shapes.ball_mesh, "cylinder": shapes.cylinder_mesh}
    return made[prop.kind]()


_AXES = {1: [0, 0, 0], 2: [0, 0, 1], 3: [0, 1, 2]}
"""Which number of its size stretches x, y and z, by how many it has."""


def _scale(prop: PropShape, size: tuple[float, ...]) -> Array:
    """(3,): what makes the unit shape that large."""
    return np.ones(3) if prop.kind == "capsule" else np.array(size)[_AXES[len(size)]]
