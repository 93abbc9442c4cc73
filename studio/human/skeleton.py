"""The canonical skeleton: 19 joints every source is mapped onto, defined geometrically."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

JOINTS: tuple[str, ...] = (
    "pelvis", "spine", "chest", "neck", "head",
    "l_shoulder", "l_elbow", "l_wrist",
    "r_shoulder", "r_elbow", "r_wrist",
    "l_hip", "l_knee", "l_ankle", "l_toe",
    "r_hip", "r_knee", "r_ankle", "r_toe",
)  # fmt: skip
NUM_JOINTS = len(JOINTS)
INDEX: dict[str, int] = {name: i for i, name in enumerate(JOINTS)}

_PARENT_NAMES: dict[str, str] = {
    "spine": "pelvis", "chest": "spine", "neck": "chest", "head": "neck",
    "l_shoulder": "chest", "l_elbow": "l_shoulder", "l_wrist": "l_elbow",
    "r_shoulder": "chest", "r_elbow": "r_shoulder", "r_wrist": "r_elbow",
    "l_hip": "pelvis", "l_knee": "l_hip", "l_ankle": "l_knee", "l_toe": "l_ankle",
    "r_hip": "pelvis", "r_knee": "r_hip", "r_ankle": "r_knee", "r_toe": "r_ankle",
}  # fmt: skip
PARENTS: tuple[int, ...] = tuple(
    INDEX[_PARENT_NAMES[name]] if name in _PARENT_NAMES else -1 for name in JOINTS
)
"""Index of each joint's parent; -1 for the pelvis."""

MIRROR: tuple[int, ...] = tuple(
    INDEX[{"l_": "r_", "r_": "l_"}.get(name[:2], name[:2]) + name[2:]] for name in JOINTS
)
"""Index of each joint's counterpart on the other side; its own for the trunk."""

BONES: tuple[str, ...] = JOINTS[1:]
"""The 18 bones, each named by its child joint: bone k ends in joint k + 1."""
NUM_BONES = len(BONES)
MIRROR_BONES = np.array(MIRROR[1:]) - 1
"""(18,) each bone's counterpart on the other side."""
BONE_CHILD = np.arange(1, NUM_JOINTS)
BONE_PARENT = np.array(PARENTS[1:])

# Each bone of a person of 1.75 m standing quietly: length (m) and direction (x forward, y left).
# Limb lengths as measured for the studio's template; the arms hang a little away from the body,
# and the toe lies lower than the ankle so that the sole is level.
_TEMPLATE_BONES: dict[str, tuple[float, tuple[float, float, float]]] = {
    "spine": (0.25, (0.0, 0.0, 1.0)),
    "chest": (0.25, (0.0, 0.0, 1.0)),
    "neck": (0.08, (0.0, 0.0, 1.0)),
    "head": (0.12, (0.0, 0.0, 1.0)),
    "shoulder": (0.19, (0.0, 1.0, 0.0)),
    "elbow": (0.29, (0.0, 0.12, -1.0)),
    "wrist": (0.25, (0.12, 0.04, -1.0)),
    "hip": (0.10, (0.0, 1.0, 0.0)),
    "knee": (0.43, (0.0, 0.0, -1.0)),
    "ankle": (0.42, (0.0, 0.0, -1.0)),
    "toe": (0.16, (0.92, 0.15, -0.36)),
}
ANKLE_HEIGHT = 0.08
"""m, ankle above the sole of a flat foot, template."""
LEG_LENGTH = _TEMPLATE_BONES["knee"][0] + _TEMPLATE_BONES["ankle"][0]
"""m, thigh plus shin of the template."""
HEAD_NECK_RATIO = _TEMPLATE_BONES["neck"][0] / (
    _TEMPLATE_BONES["neck"][0] + _TEMPLATE_BONES["head"][0]
)
"""Where the neck lies between chest and head; no two sensors agree on a neck of their own."""


def _template_bones() -> tuple[Array, Array]:
    lengths, directions = [], []
    for bone in BONES:
        length, direction = _TEMPLATE_BONES[bone.removeprefix("l_").removeprefix("r_")]
        side = -1.0 if bone.startswith("r_") else 1.0
        d = np.array(direction) * (1.0, side, 1.0)
        lengths.append(length)
        directions.append(d / np.linalg.norm(d))
    return np.array(lengths), np.array(directions)


BONE_LENGTH, NEUTRAL_DIRECTION = _template_bones()
"""Template bone lengths (18,) m, and directions (18, 3) of the neutral pose, heading frame."""


def _chain() -> Array:
    chain = np.zeros((NUM_JOINTS, NUM_BONES))
    for joint in range(1, NUM_JOINTS):
        chain[joint] = chain[PARENTS[joint]]
        chain[joint, joint - 1] = 1.0
    return chain


CHAIN = _chain()
"""(19, 18): joint positions relative to the pelvis = CHAIN @ bone vectors."""

NEUTRAL: Array = CHAIN @ (NEUTRAL_DIRECTION * BONE_LENGTH[:, None])
NEUTRAL[:, 2] += LEG_LENGTH + ANKLE_HEIGHT
"""(19, 3) m: the template standing quietly, facing +x, soles at z = 0, pelvis above the origin."""
