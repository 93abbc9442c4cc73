"""Bones of a Unity humanoid, each as last heard → where its joints are, and how sure that is."""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from studio.geometry import scalars
from studio.human.sensor_skeletons import SourceSkeleton, axes_for, skeleton_of
from studio.mocap.raw_frame import FrameRejected

Array = NDArray[np.float64]
Transform = tuple[scalars.Vec, scalars.Quat]
"""Position (3,) m and rotation (4,) wxyz against the parent, in Unity's axes. Its world is
left-handed (x right, y up, z forward), and Hamilton's product is the same in it."""

KEPT_FRAMES = 5
"""Frames that a bone is believed for when its packets are lost; a new avatar may lack it."""
MAX_STRETCH = 0.1
"""Share of its length by which a bone may stretch between two frames, as some solvers have it."""
MAX_OFFSET = 1e4
"""m between a bone and its parent; of the root, from the origin."""

_TRUNK = ("Hips", "Spine", "Chest", "UpperChest", "Neck", "Head")
_LIMBS = (
    ("UpperChest", ("Shoulder", "UpperArm", "LowerArm", "Hand")),
    ("Hips", ("UpperLeg", "LowerLeg", "Foot", "Toes")),
)


def _parents() -> dict[str, str]:
    out: dict[str, str] = dict(zip(_TRUNK, ("", *_TRUNK)))
    for side in ("Left", "Right"):
        for origin, chain in _LIMBS:
            bones = [side + bone for bone in chain]
            out |= dict(zip(bones, (origin, *bones)))
    return out


PARENTS = _parents()
"""Each bone's parent as Unity's HumanBodyBones have it, parents first; "" is the avatar's root."""
OPTIONAL = frozenset({"Chest", "UpperChest", "Neck", "LeftShoulder", "RightShoulder"})
"""Bones a humanoid may lack: those below are then attached to the one above."""

VMC: SourceSkeleton = skeleton_of(
    "vmc",
    tuple(PARENTS),
    axes_for("y", mirrored=True),
    {
        "head": ["Head"],
        **{
            f"{side[0].lower()}_{joint}": [side + bone]
            for side in ("Left", "Right")
            for joint, bone in (
                ("shoulder", "UpperArm"), ("elbow", "LowerArm"), ("wrist", "Hand"),
                ("hip", "UpperLeg"), ("knee", "LowerLeg"), ("ankle", "Foot"), ("toe", "Toes"),
            )
        },
    },
)  # fmt: skip
"""A bone of a humanoid begins at its joint: UpperArm at the shoulder."""


class Avatar:
    """Remembers each bone's transform, and in which frame it was heard. One thread."""

    def __init__(self) -> None:
        self.clear()

    def clear(self) -> None:
        """Another sender, or no avatar: nothing is known."""
        self._frame = 0
        self._root: Transform = ((0.0, 0.0, 0.0), (1.0, 0.0, 0.0, 0.0))
        self._heard: dict[str, tuple[int, Transform]] = {}

    def set_root(self, numbers: Sequence[float]) -> None:
        """Where the avatar stands; numbers as of `set_bone`."""
        self._root = _transform("the root", numbers)

    def set_bone(self, name: str, numbers: Sequence[float]) -> None:
        """numbers: (≥ 7,) position x y z (m), quaternion x y z w. FrameRejected if unfit. Bones
        that move no joint of ours (fingers, eyes) are left alone."""
        if name not in PARENTS:
            return
        local = _transform(name, numbers)
        before = self._heard.get(name)
        if before is not None and name != "Hips" and _resized(before[1][0], local[0]):
            self._heard.clear()  # bones keep their length: this is another avatar's
        self._heard[name] = (self._frame, local)

    def end_frame(self) -> tuple[Array, Array] | None:
        """Positions (21, 3) m in Unity's axes and confidence (21,), in PARENTS' order, by the
        bones heard of lately. None where there is no pelvis yet."""
        oldest = self._frame - KEPT_FRAMES
        here = {name: local for name, (frame, local) in self._heard.items() if frame >= oldest}
        self._frame += 1
        world: dict[str, Transform] = {"": self._root}
        for name, parent in PARENTS.items():
            while parent in OPTIONAL and parent not in here:
                parent = PARENTS[parent]
            if name in here and parent in world:
                ((x, y, z), turned), (offset, own) = world[parent], here[name]
                dx, dy, dz = scalars.turn(turned, offset)
                world[name] = (x + dx, y + dy, z + dz), scalars.mul(turned, own)
        if not {"LeftUpperLeg", "RightUpperLeg"} <= world.keys():
            return None
        hips = world["Hips"]
        positions = np.array([world.get(name, hips)[0] for name in PARENTS])
        return positions, np.array([float(name in world) for name in PARENTS])


def _resized(before: scalars.Vec, now: scalars.Vec) -> bool:
    was = math.hypot(*before)
    return abs(math.hypot(*now) - was) > 0.01 + MAX_STRETCH * was


def _transform(name: str, numbers: Sequence[float]) -> Transform:
    """Comparisons are written so that NaN fails them."""
    if len(numbers) < 7 or not all(abs(n) <= MAX_OFFSET for n in numbers[:7]):
        raise FrameRejected(
            f"{name}: a position in m (x y z) and a quaternion (x y z w) are needed"
        )
    px, py, pz, x, y, z, w = numbers[:7]
    length = math.sqrt(w * w + x * x + y * y + z * z)
    if not 0.5 <= length <= 2.0:
        raise FrameRejected(f"{name}: a quaternion of length {length:.3g}; 1 would fit")
    return (px, py, pz), (w / length, x / length, y / length, z / length)
