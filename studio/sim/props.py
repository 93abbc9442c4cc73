"""What stands, hangs and lies beside the robot: each prop is one shape, added to the MuJoCo model.

A prop is data, so that whoever draws it needs no simulator; called with a spec it is a `Prop`.
"""

from dataclasses import dataclass
from typing import Literal

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio import geometry
from studio.sim.spec import ROBOT_BIT, WORLD_BIT

Kind = Literal["box", "ball", "cylinder", "capsule"]
Held = Literal["ground", "fixed", "free", "hung", "drawn"]

_KINDS = {
    "box": mujoco.mjtGeom.mjGEOM_BOX,
    "ball": mujoco.mjtGeom.mjGEOM_SPHERE,
    "cylinder": mujoco.mjtGeom.mjGEOM_CYLINDER,
    "capsule": mujoco.mjtGeom.mjGEOM_CAPSULE,
}
_SIZES = {"box": 3, "ball": 1, "cylinder": 2, "capsule": 2}
_SWING_DAMPING = [0.03, 0.0002, 0.0]
"""N s/m and N m s/rad of what hangs: what is touched comes to rest within some seconds."""
Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class PropShape:
    """One prop. SI units, world frame.

    kind, size: box: half edges (x, y, z); ball: (radius,); cylinder, capsule: (radius, half
    length), along z. pos: (x, y, z) of its centre at reset. rpy: rad.
    held: "ground" can be walked on, and who lies on it has fallen; "fixed" stands still; "free" may
    go anywhere; "hung" swings on a string of `string` m and meets nothing but the robot; "drawn" is
    met by nothing (a mark on the floor).
    overhang: (by, up to), m, of a free box on a smaller foot: `by` smaller on each side, up to that
    height.
    mass: kg, of what is free or hung. friction: on the floor; where the robot touches, the robot's
    own counts. rolling: m, what slows a rolling ball. color: RGB in [0, 1].
    """

    name: str
    kind: Kind
    size: tuple[float, ...]
    pos: tuple[float, float, float]
    rpy: tuple[float, float, float] = (0.0, 0.0, 0.0)
    held: Held = "fixed"
    mass: float = 0.1
    friction: float = 0.6
    rolling: float = 0.002
    string: float = 0.6
    overhang: tuple[float, float] | None = None
    color: tuple[float, float, float] = (0.9, 0.5, 0.2)

    def __post_init__(self) -> None:
        assert len(self.size) == _SIZES[self.kind], (self.name, self.kind, self.size)

    @property
    def bodied(self) -> bool:
        """A body of its own: it may be elsewhere than declared."""
        return self.held not in ("ground", "drawn")

    def __call__(self, spec: mujoco.MjSpec) -> None:
        """Add it to the world."""
        quat = geometry.quat_from_rpy(self.rpy)
        if not self.bodied:
            self._shape(spec.worldbody, self.size, self.pos, quat)
            return
        # What is fixed is "mocap" to MuJoCo, or it would become part of the ground when compiled.
        fixed = self.held == "fixed"
        body = spec.worldbody.add_body(name=self.name, pos=self.pos, quat=quat, mocap=fixed)
        if self.held == "free":
            body.add_freejoint(name=self.name)
        elif self.held == "hung":
            body.add_joint(name=self.name, type=mujoco.mjtJoint.mjJNT_FREE, damping=_SWING_DAMPING)
            self._tie(spec, body)
        for part, (size, up) in zip(("", "_foot"), self.parts(), strict=False):
            self._shape(body, size, (0.0, 0.0, up), geometry.IDENTITY_QUAT, part)

    def parts(self) -> list[tuple[tuple[float, ...], float]]:
        """What it is made of, all of its kind: (size, m above its centre)."""
        if self.overhang is None:
            return [(self.size, 0.0)]
        (x, y, z), (by, high) = self.size, self.overhang
        top, foot = (x, y, z - 0.5 * high), (x - by, y - by, 0.5 * high)
        return [(top, 0.5 * high), (foot, 0.5 * high - z)]

    def _tie(self, spec: mujoco.MjSpec, body: mujoco.MjsBody) -> None:
        """A string from above it to its top: it pulls and never pushes, so that what lifts or
        pushes down the prop meets no more than its weight."""
        high = self.size[-1]
        tie = body.add_site(name=f"{self.name}_tie", pos=[0.0, 0.0, high])
        top = spec.worldbody.add_site(name=f"{self.name}_top", pos=self.hook(self.pos))
        string = spec.add_tendon(
            name=self.name, limited=True, range=[0.0, self.string], solref_limit=[0.01, 1.0]
        )
        string.wrap_site(top.name)
        string.wrap_site(tie.name)

    def hook(self, pos: ArrayLike) -> Array:
        """(3,) m, world: where the string of a hung prop begins whose centre rests at `pos`."""
        return np.asarray(pos, dtype=np.float64) + [0.0, 0.0, self.size[-1] + self.string]

    def _shape(self, body: mujoco.MjsBody, size, pos, quat, part: str = "") -> None:
        meets = {"drawn": (0, 0), "hung": (0, ROBOT_BIT)}
        contype, conaffinity = meets.get(self.held, (WORLD_BIT, WORLD_BIT | ROBOT_BIT))
        body.add_geom(
            name=self.name + part,
            type=_KINDS[self.kind],
            size=[*size, 0.0, 0.0][:3],
            pos=pos,
            quat=quat,
            mass=self.mass / (1 if self.overhang is None else 2),
            contype=contype,
            conaffinity=conaffinity,
            condim=6 if self.kind == "ball" else 3,
            friction=[self.friction, 0.005, self.rolling],
            rgba=[*self.color, 1.0],
        )
