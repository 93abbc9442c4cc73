"""How thick a person is where: radii of the bones and joints that they are drawn with."""

import numpy as np

from studio.human.skeleton import INDEX, NUM_JOINTS, PARENTS

# Radius across the body and front to back, m, of the bone that ends in each joint.
_BONE_RADII: dict[str, tuple[float, float]] = {
    "spine": (0.125, 0.095), "chest": (0.155, 0.105), "neck": (0.055, 0.055), "head": (0.05, 0.05),
    "shoulder": (0.06, 0.06), "elbow": (0.047, 0.047), "wrist": (0.038, 0.038),
    "hip": (0.085, 0.085), "knee": (0.077, 0.077), "ankle": (0.055, 0.055), "toe": (0.04, 0.034),
}  # fmt: skip
_JOINT_RADII: dict[str, float] = {
    "pelvis": 0.1, "spine": 0.094, "chest": 0.1, "neck": 0.056, "head": 0.112, "shoulder": 0.062,
    "elbow": 0.045, "wrist": 0.043, "hip": 0.084, "knee": 0.06, "ankle": 0.045, "toe": 0.034,
}  # fmt: skip


def part_of(name: str) -> str:
    """A joint without its side."""
    return name.split("_")[-1]


JOINT_RADII = np.array([_JOINT_RADII[part_of(name)] for name in INDEX])
"""(19,) m."""
BONES: tuple[int, ...] = tuple(i for i in range(NUM_JOINTS) if PARENTS[i] >= 0)
"""Joint in which each of the 18 bones ends; it starts in that joint's parent."""
_NAMES = tuple(INDEX)
BONE_RADII = np.array([_BONE_RADII[part_of(_NAMES[i])] for i in BONES])
"""(18, 2) m, across the body and front to back."""
