"""The shapes the view is made of, as plain arrays: the person's bones, discs for contacts.

A bone is one tapered solid of revolution about +z, from z = 0 to 1 with radius 1, drawn once and
scaled for each bone: (radius_x, radius_y, length). Everything here is pure numpy.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.shape import BONE_RADII, BONES, part_of
from studio.human.skeleton import INDEX, PARENTS

Array = NDArray[np.float64]
LIMB_COLOR = (222, 130, 84)
TRUNK_COLOR = (204, 104, 62)
JOINT_COLOR = (233, 158, 116)

_NAMES = tuple(INDEX)
BONE_COLORS = np.array(
    [TRUNK_COLOR if part_of(_NAMES[i]) in ("spine", "chest", "hip") else LIMB_COLOR for i in BONES],
    dtype=np.uint8,
)
JOINT_COLORS = np.array(
    [TRUNK_COLOR if n in ("pelvis", "spine", "chest") else JOINT_COLOR for n in _NAMES],
    dtype=np.uint8,
)
BONE_START = np.array([PARENTS[i] for i in BONES])
BONE_END = np.array(BONES)


@dataclass(frozen=True, kw_only=True)
class Mesh:
    """vertices (V, 3) float32, m; faces (F, 3) uint32, counter-clockwise from outside."""

    vertices: NDArray[np.float32]
    faces: NDArray[np.uint32]


def revolved(profile: list[tuple[float, float]], segments: int = 12) -> Mesh:
    """A closed solid of revolution about +z from (radius, z) pairs, bottom to top."""
    angle = np.linspace(0.0, 2.0 * np.pi, segments, endpoint=False)
    ring = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    rings = [np.column_stack([r * ring, np.full(segments, z)]) for r, z in profile]
    low, high = len(rings) * segments, len(rings) * segments + 1
    caps = [[(0.0, 0.0, profile[0][1])], [(0.0, 0.0, profile[-1][1])]]
    faces: list[tuple[int, int, int]] = []
    for i in range(segments):
        j = (i + 1) % segments
        faces.append((low, j, i))
        for k in range(len(rings) - 1):
            a, b = k * segments, (k + 1) * segments
            faces += [(a + i, a + j, b + j), (a + i, b + j, b + i)]
        top = (len(rings) - 1) * segments
        faces.append((high, top + i, top + j))
    return Mesh(
        vertices=np.concatenate([*rings, *caps]).astype(np.float32),
        faces=np.array(faces, dtype=np.uint32),
    )


def bone_mesh() -> Mesh:
    """A limb: fuller near its start, slimmer at its end."""
    profile = [(0.86, 0.0), (0.96, 0.12), (1.0, 0.32), (0.95, 0.6), (0.86, 0.85), (0.8, 1.0)]
    return revolved(profile)


def ball_mesh() -> Mesh:
    """A unit sphere."""
    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 9)[1:-1]
    profile = [(float(np.cos(t)), float(np.sin(t))) for t in theta]
    mesh = revolved(profile, 14)
    mesh.vertices[-2], mesh.vertices[-1] = (0, 0, -1), (0, 0, 1)
    return mesh


def disc_mesh() -> Mesh:
    """A flat disc of radius 1, lying on the ground."""
    return revolved([(1.0, 0.0), (1.0, 0.02)], 24)


def box_mesh() -> Mesh:
    """A cube with half edges of 1, its faces apart so that its edges are sharp."""
    corners, faces = [], []
    for axis in range(3):
        for side in (-1.0, 1.0):
            a, b = np.roll(np.eye(3), axis, axis=1)[1:]
            middle = side * np.roll(np.eye(3), axis, axis=1)[0]
            n = len(corners)
            corners += [middle - a - b, middle + a - b, middle + a + b, middle - a + b]
            quad = [n, n + 1, n + 2, n + 3][:: int(side)]
            faces += [quad[:3], [quad[0], quad[2], quad[3]]]
    return Mesh(
        vertices=np.array(corners, dtype=np.float32), faces=np.array(faces, dtype=np.uint32)
    )


def cylinder_mesh() -> Mesh:
    """Along z from -1 to 1 with radius 1; rings twice, so that its rims are sharp."""
    return revolved([(1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (1.0, 1.0)], 24)


def rod_mesh() -> Mesh:
    """Along z from 0 to 1 with radius 1, seen as a thread."""
    return revolved([(1.0, 0.0), (1.0, 1.0)], 5)


def capsule_mesh(radius: float, half: float) -> Mesh:
    """Along z, its caps' centres at -half and half, m."""
    theta = np.linspace(-0.5 * np.pi, 0.5 * np.pi, 10)
    profile = [
        (radius * float(np.cos(t)), radius * float(np.sin(t)) + half * float(np.sign(t)))
        for t in theta[1:-1]
    ]
    mesh = revolved(profile, 14)
    mesh.vertices[-2], mesh.vertices[-1] = (0, 0, -half - radius), (0, 0, half + radius)
    return mesh


def quat_along(direction: Array) -> Array:
    """(n, 4) wxyz that turn z along directions (n, 3), none of them straight down."""
    x, y, z = geometry.normalize(direction).T
    return geometry.normalize(np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=-1))


def bone_transforms(joint_pos: Array) -> tuple[Array, Array, Array]:
    """Position (18, 3), wxyz (18, 4) and scale (18, 3) of each bone for joints (19, 3), m.

    z runs along the bone, x across the body, so that the trunk is broad from the front.
    """
    start = joint_pos[BONE_START]
    along = joint_pos[BONE_END] - start
    length = np.linalg.norm(along, axis=-1)
    z = geometry.normalize(along)
    z[length < 1e-9] = (0.0, 0.0, 1.0)
    across = joint_pos[INDEX["l_hip"]] - joint_pos[INDEX["r_hip"]]
    upper = joint_pos[INDEX["l_shoulder"]] - joint_pos[INDEX["r_shoulder"]]
    hint = np.broadcast_to(across, z.shape).copy()
    hint[: INDEX["l_hip"] - 1] = upper
    hint[0] = across  # the lower trunk turns with the hips
    x = hint - (hint * z).sum(-1, keepdims=True) * z
    # A bone that lies across the body (a collar bone) has no such direction: any other will do.
    thin = np.linalg.norm(x, axis=-1) < 0.3 * np.linalg.norm(hint, axis=-1) + 1e-9
    other = np.eye(3)[np.argmin(np.abs(z), axis=-1)]
    x[thin] = (other - (other * z).sum(-1, keepdims=True) * z)[thin]
    x = geometry.normalize(x)
    rotation = np.stack([x, np.cross(z, x), z], axis=-1)
    scale = np.column_stack([BONE_RADII, length])
    return start, geometry.quat_from_matrix(rotation), scale
