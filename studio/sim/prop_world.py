"""A World with props: where each is, what touched it, and how to throw one."""

from collections.abc import Sequence
from dataclasses import dataclass

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.robot.pose import RobotPose, RobotState
from studio.sim.props import PropShape
from studio.sim.world import World, WorldConfig

Array = NDArray[np.float64]
NEAR = 1e-3
"""m: what is nearer touches, as for the robot's own contacts."""


@dataclass(frozen=True, kw_only=True)
class PropPoses:
    """Where the props are that have bodies of their own (`PropShape.bodied`), in their order.

    pos (n, 3) m, quat (n, 4) wxyz, world. hooks (n, 3) m: where the string of each begins; the
    prop's own place for what does not hang.
    """

    pos: Array
    quat: Array
    hooks: Array


class PropWorld(World):
    """As World. touched: (prop, what touched it) of the last control period: a capsule of the
    robot ("FR_foot", "trunk_left" …) or another prop; a touch between two periods counts. The
    ground is not told. One thread at a time.
    """

    def __init__(
        self,
        props: Sequence[PropShape],
        seed: int = 0,
        config: WorldConfig | None = None,
    ) -> None:
        self.props = {prop.name: prop for prop in props}
        self.touched: frozenset[tuple[str, str]] = frozenset()
        self._pairs: set[tuple[int, int]] = set()
        self._geom_told = np.zeros(0, dtype=bool)
        super().__init__(config or WorldConfig(), seed, props)

    def _classify_geoms(self) -> None:
        super()._classify_geoms()
        model, props = self.model, self.props
        body = [model.body(int(b)).name for b in model.geom_bodyid]
        self._geom_name = [b if b in props else model.geom(i).name for i, b in enumerate(body)]
        self._geom_told = np.array([b in props for b in body])
        bodied = [prop for prop in props.values() if prop.bodied]
        hung = [prop.held == "hung" for prop in bodied]
        self._bodies = np.array([model.body(p.name).id for p in bodied], dtype=np.intp)
        self._hung = np.flatnonzero(hung)
        tops = [model.site(f"{bodied[k].name}_top").id for k in self._hung]
        self._tops = np.array(tops, dtype=np.intp)
        self._geom_ground = np.array([b == "world" for b in body])

    def reset(self, pose: RobotPose | None = None) -> RobotState:
        """As World's; what touched before is forgotten."""
        self.touched = frozenset()
        return super().reset(pose)

    def step(self, target: ArrayLike, steps: int | None = None) -> RobotState:
        """As World's."""
        self._pairs.clear()
        state = super().step(target, steps)
        named = [(self._geom_name[a], self._geom_name[b]) for a, b in self._pairs]
        self.touched = frozenset(
            pair for a, b in named for pair in ((a, b), (b, a)) if pair[0] in self.props
        )
        return state

    def _substep(self) -> None:
        super()._substep()
        contact = self.data.contact
        pairs = contact.geom[contact.dist < NEAR]
        told = self._geom_told[pairs].any(axis=1) & ~self._geom_ground[pairs].any(axis=1)
        self._pairs.update((int(a), int(b)) for a, b in pairs[told])

    def position(self, name: str) -> Array:
        """(3,) m, world: the centre of a prop."""
        if not self.props[name].bodied:
            return self.data.geom(name).xpos.copy()
        return self.data.body(name).xpos.copy()

    def hidden(self, eye: ArrayLike, point: ArrayLike, name: str) -> bool:
        """Another prop, or the ground, lies between an eye and a point of the prop `name`: (3,) m,
        world, each. The robot hides nothing: its capsules are wider than its legs."""
        start, end = (np.asarray(each, dtype=np.float64) for each in (eye, point))
        met = np.zeros(1, dtype=np.int32)
        while (left := float(np.linalg.norm(end - start))) > NEAR:
            way = (end - start) / left
            far = mujoco.mj_ray(self.model, self.data, start, way, None, 1, -1, met)
            if met[0] < 0 or far > left - NEAR or self._geom_name[met[0]] == name:
                return False
            if not self._geom_robot[met[0]]:
                return True
            start = start + (far + NEAR) * way
        return False

    def poses(self) -> PropPoses:
        """Of those that have bodies, now; arrays of its own."""
        pos = self.data.xpos[self._bodies]
        hooks = pos.copy()
        hooks[self._hung] = self.model.site_pos[self._tops]
        return PropPoses(pos=pos, quat=self.data.xquat[self._bodies], hooks=hooks)

    def put(self, name: str, pos: ArrayLike) -> None:
        """A prop to (3,) m, at rest and turned as declared: free, hung or fixed."""
        prop, body = self.props[name], self.model.body(name)
        if prop.held == "fixed":
            self.data.mocap_pos[body.mocapid[0]] = pos
            mujoco.mj_kinematics(self.model, self.data)
            return
        if prop.held == "hung":
            self.model.site(f"{name}_top").pos = prop.hook(pos)
        self.throw(name, pos)

    def throw(self, name: str, pos: ArrayLike, lin_vel_w: ArrayLike = (0.0, 0.0, 0.0)) -> None:
        """A free prop goes on from pos (3,) m, turned as declared, with lin_vel_w (3,) m/s."""
        joint = self.data.joint(name)
        quat = geometry.quat_from_rpy(self.props[name].rpy)
        joint.qpos[:] = [*np.asarray(pos, dtype=np.float64), *quat]
        joint.qvel[:] = [*np.asarray(lin_vel_w, dtype=np.float64), 0.0, 0.0, 0.0]
        mujoco.mj_kinematics(self.model, self.data)
