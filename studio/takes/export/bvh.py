"""Human joint positions to a BVH file, as animation programs read it.

A BVH stores rotations of rigid bones: bone lengths are the medians over the clip, each joint's
rotation is the one that best turns its rest bones (upright, arms hanging) into the measured ones
(Kabsch's solution of Wahba's problem; one bone: the shortest turn). Y-up, centimetres, 60 ° or
more is no difficulty: angles are written z-y-x intrinsic, in degrees.
"""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.skeleton import INDEX, JOINTS, PARENTS
from studio.robot import a1
from studio.takes.export.extent import human_poses, steady_human
from studio.takes.take import Take

Array = NDArray[np.float64]

_DOWN, _UP, _LEFT = np.array([0.0, 0, -1]), np.array([0.0, 0, 1]), np.array([0.0, 1, 0])
_REST_DIRECTION = {
    "spine": _UP, "chest": _UP, "neck": _UP, "head": _UP,
    "l_shoulder": _LEFT, "l_elbow": _DOWN, "l_wrist": _DOWN,
    "r_shoulder": -_LEFT, "r_elbow": _DOWN, "r_wrist": _DOWN,
    "l_hip": _LEFT, "l_knee": _DOWN, "l_ankle": _DOWN, "l_toe": np.array([1.0, 0, 0]),
    "r_hip": -_LEFT, "r_knee": _DOWN, "r_ankle": _DOWN, "r_toe": np.array([1.0, 0, 0]),
}  # fmt: skip
CHILDREN = tuple(tuple(c for c, p in enumerate(PARENTS) if p == j) for j in range(len(JOINTS)))


def write_bvh(path: Path, joint_pos_w: Array, dt: float) -> None:
    """Write positions (T, 19, 3) m, z up, at a period of dt s, as a BVH in centimetres, Y-up."""
    offsets = _rest_offsets(joint_pos_w)
    local = _local_rotations(joint_pos_w, offsets)
    lines = ["HIERARCHY", *_hierarchy(0, 0, offsets)]
    lines += ["MOTION", f"Frames: {len(joint_pos_w)}", f"Frame Time: {dt:.8f}"]
    order = _depth_first(0)
    angles = np.rad2deg(geometry.quat_to_rpy(_y_up_quat(local)))[:, order][..., [2, 1, 0]]
    root = _y_up(joint_pos_w[:, 0]) * 100.0
    rows = np.concatenate([root, angles.reshape(len(root), -1)], axis=1)
    lines += [" ".join(f"{v:.5f}" for v in row) for row in rows]
    path.write_text("\n".join(lines) + "\n")


def _rest_offsets(joint_pos_w: Array) -> Array:
    """(19, 3) m: each joint from its parent in the rest pose."""
    out = np.zeros((len(JOINTS), 3))
    for j, parent in enumerate(PARENTS):
        if parent >= 0:
            lengths = np.linalg.norm(joint_pos_w[:, j] - joint_pos_w[:, parent], axis=-1)
            out[j] = float(np.median(lengths)) * _REST_DIRECTION[JOINTS[j]]
    return out


def _local_rotations(joint_pos_w: Array, offsets: Array) -> Array:
    """(T, 19, 4) wxyz: each joint's rotation relative to its parent."""
    n = len(joint_pos_w)
    world = np.tile(geometry.IDENTITY_QUAT, (n, len(JOINTS), 1))
    local = world.copy()
    for j in _depth_first(0):
        parent = PARENTS[j]
        inherited = world[:, parent] if parent >= 0 else np.tile(geometry.IDENTITY_QUAT, (n, 1))
        children = list(CHILDREN[j])
        if children:
            bones = joint_pos_w[:, children] - joint_pos_w[:, [j]]
            # Solved in the inherited frame: a single bone is turned the shortest way from there.
            bones = geometry.quat_rotate_inverse(inherited[:, None], bones)
            local[:, j] = _best_rotation(offsets[children], bones)
        world[:, j] = geometry.quat_mul(inherited, local[:, j])
    return local


def _best_rotation(rest: Array, bones: Array) -> Array:
    """Rotations (T, 4) minimising the distance of R rest (C, 3) to bones (T, C, 3)."""
    rest, bones = geometry.normalize(rest), geometry.normalize(bones)
    if len(rest) == 1:
        axis = np.cross(rest[0], bones[:, 0])
        w = 1.0 + bones[:, 0] @ rest[0]
        # Opposite directions leave the axis open: any horizontal one will do.
        axis = np.where(w[:, None] < 1e-9, [1.0, 0.0, 0.0], axis)
        return geometry.normalize(np.concatenate([w[:, None], axis], axis=-1))
    u, _, vt = np.linalg.svd(np.einsum("tci,cj->tij", bones, rest))
    sign = np.ones((len(bones), 3))
    sign[:, 2] = np.sign(np.linalg.det(u @ vt))
    return geometry.quat_from_matrix((u * sign[:, None]) @ vt)


def _depth_first(j: int) -> list[int]:
    return [j, *(k for c in CHILDREN[j] for k in _depth_first(c))]


def _hierarchy(j: int, depth: int, offsets: Array) -> list[str]:
    pad = "\t" * depth
    offset = " ".join(f"{v:.5f}" for v in _y_up(offsets[j]) * 100.0)
    position = "Xposition Yposition Zposition " if depth == 0 else ""
    channels = 6 if depth == 0 else 3
    out = [
        f"{pad}{'ROOT' if depth == 0 else 'JOINT'} {JOINTS[j]}",
        f"{pad}{{",
        f"{pad}\tOFFSET {offset}",
        f"{pad}\tCHANNELS {channels} {position}Zrotation Yrotation Xrotation",
    ]
    for child in CHILDREN[j]:
        out += _hierarchy(child, depth + 1, offsets)
    if not CHILDREN[j]:
        end = "0.00000 0.00000 5.00000" if "toe" in JOINTS[j] else "0.00000 5.00000 0.00000"
        out += [f"{pad}\tEnd Site", f"{pad}\t{{", f"{pad}\t\tOFFSET {end}", f"{pad}\t}}"]
    return [*out, f"{pad}}}"]


def _y_up(v: Array) -> Array:
    """(forward, left, up) to the file's axes: x left, y up, z forward."""
    return np.asarray(v)[..., [1, 2, 0]]


def _y_up_quat(q: Array) -> Array:
    return np.concatenate([q[..., :1], _y_up(q[..., 1:])], axis=-1)


assert INDEX["pelvis"] == 0, "the root of the hierarchy is the first joint"


def write_human_bvh(take: Take, path: Path) -> None:
    """The human as a BVH at 30 Hz, a frame a tick: a pause lasts as long as it did.

    Raises StudioError for a take without a human.
    """
    joints = steady_human(take)
    if not len(joints):
        raise StudioError(nobody(take))
    write_bvh(path, joints, a1.CONTROL_DT)


def some_poses(take: Take) -> list[HumanPose]:
    """The fresh poses within the trim; StudioError when there are none."""
    poses = human_poses(take)
    if not poses:
        raise StudioError(nobody(take))
    return poses


def nobody(take: Take) -> str:
    """Why there is no person to export."""
    return f"take {take.name} has no human motion to export; try npz or csv"
