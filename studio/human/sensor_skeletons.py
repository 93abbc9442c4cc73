"""The skeletons sensors and files speak, and the linear map of each onto the canonical joints."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.errors import unknown_name
from studio.human.skeleton import HEAD_NECK_RATIO, INDEX, JOINTS, NUM_JOINTS, PARENTS

Array = NDArray[np.float64]

# Rows are (forward, left, up) in the source's own axes: canonical = axes @ source.
AXES_STUDIO: Array = np.eye(3)
AXES_CAMERA_Y_DOWN: Array = np.array([[0, 0, -1], [1, 0, 0], [0, -1, 0]], dtype=float)
"""MediaPipe and Azure Kinect: x to the image's right, y down, z away; the person faces it."""
AXES_KINECT2: Array = np.array([[0, 0, -1], [-1, 0, 0], [0, 1, 0]], dtype=float)
"""Kinect v2: x to the sensor's left, which is the facing person's right, y up, z away."""


def axes_for(up: str, mirrored: bool = False) -> Array:
    """The axes (3, 3) of a world whose `up` is "x", "y", "z" or one of these with a "-": the
    rotation matrix (mirrored: times a reflection) by which its positions become ours.

    right-handed, people facing the axis after it (+z in a y-up world); mirrored: left-handed.
    """
    sign, axis = (-1.0 if up[0] == "-" else 1.0), "xyz".index(up[-1])
    out = np.zeros((3, 3))
    out[0, (axis + 1) % 3] = 1.0
    out[1, (axis + 2) % 3] = -sign if mirrored else sign
    out[2, axis] = sign
    return out


AXES_Y_UP: Array = axes_for("y")
"""BVH and other right-handed Y-up worlds with people facing +z at rest."""


@dataclass(frozen=True, kw_only=True)
class SourceSkeleton:
    """A source's joints, and how they become canonical ones.

    name: as frames name it. joints: the source's joint names in order. axes: (3, 3), canonical
    vector = axes @ source vector. weights: (19, n), canonical joints = weights @ source joints;
    an all-zero row is a joint the source lacks. full_confidence: the sensor's figure for "seen".
    """

    name: str
    joints: tuple[str, ...]
    axes: Array
    weights: Array
    full_confidence: float = 1.0

    def __post_init__(self) -> None:
        assert self.weights.shape == (NUM_JOINTS, len(self.joints)), self.weights.shape
        object.__setattr__(self, "_absent", np.where(self.weights != 0.0, 0.0, np.inf))
        object.__setattr__(self, "_lacks", ~self.weights.any(axis=1))
        filled = self.weights.copy()
        for joint in np.flatnonzero(~self.weights.any(axis=1)):
            filled[joint] = filled[PARENTS[joint]]  # parents come first, so theirs is filled
        object.__setattr__(self, "_filled", filled)

    @property
    def num_joints(self) -> int:
        """Joints in a frame of this skeleton."""
        return len(self.joints)

    @property
    def found(self) -> dict[str, tuple[str, ...]]:
        """Each canonical joint there is, and the source's joints it is made of."""
        lacks: NDArray[np.bool_] = self._lacks  # type: ignore[attr-defined]
        return {
            joint: tuple(self.joints[k] for k in np.flatnonzero(self.weights[i]))
            for i, joint in enumerate(JOINTS)
            if not lacks[i]
        }

    @property
    def up_axis(self) -> str:
        """The source's axis that points up: "y", "-y" …"""
        axis = int(np.argmax(np.abs(self.axes[2])))
        return ("-" if self.axes[2, axis] < 0.0 else "") + "xyz"[axis]

    def to_canonical(
        self, positions: ArrayLike, confidence: ArrayLike | None = None
    ) -> tuple[Array, Array]:
        """Canonical joint_pos_w (..., 19, 3) m and confidence (..., 19) of source joints.

        positions: (..., n, 3) m in the source's axes. confidence: (..., n), as the sensor gives
        it; None means all seen. A canonical joint is as sure as the least sure joint it is made
        of; one the source lacks lies on its parent with confidence 0.
        """
        positions = np.asarray(positions, dtype=np.float64)
        assert positions.shape[-2:] == (self.num_joints, 3), positions.shape
        out = self._filled @ positions @ self.axes.T  # type: ignore[attr-defined]
        lacks: NDArray[np.bool_] = self._lacks  # type: ignore[attr-defined]
        if confidence is None:
            sure = np.broadcast_to(np.where(lacks, 0.0, 1.0), out.shape[:-1]).copy()
        else:
            c = np.asarray(confidence, dtype=np.float64)[..., None, :] / self.full_confidence
            sure = np.minimum((c + self._absent).min(axis=-1), 1.0)  # type: ignore[attr-defined]
            sure[..., lacks] = 0.0
        return out, sure


def skeleton_of(
    name: str,
    joints: Sequence[str],
    axes: Array,
    parts: Mapping[str, Sequence[str]],
    full_confidence: float = 1.0,
) -> SourceSkeleton:
    """Build the map: each canonical joint is the mean of the source joints named in `parts`.

    The trunk is then defined geometrically, whatever spine the source has: pelvis = mid-hip,
    chest = mid-shoulder, spine = their middle, neck a fixed share of the way from chest to head.
    axes: (3, 3), from the source's world to ours.
    """
    index = {joint: i for i, joint in enumerate(joints)}
    w = np.zeros((NUM_JOINTS, len(joints)))
    for canonical, sources in parts.items():
        for source in sources:
            w[INDEX[canonical], index[source]] += 1.0 / len(sources)
    w[INDEX["pelvis"]] = 0.5 * (w[INDEX["l_hip"]] + w[INDEX["r_hip"]])
    w[INDEX["chest"]] = 0.5 * (w[INDEX["l_shoulder"]] + w[INDEX["r_shoulder"]])
    w[INDEX["spine"]] = 0.5 * (w[INDEX["pelvis"]] + w[INDEX["chest"]])
    if w[INDEX["head"]].any():
        head = w[INDEX["head"]]
        w[INDEX["neck"]] = HEAD_NECK_RATIO * head + (1.0 - HEAD_NECK_RATIO) * w[INDEX["chest"]]
    return SourceSkeleton(
        name=name, joints=tuple(joints), axes=axes, weights=w, full_confidence=full_confidence
    )


def _sided(parts: dict[str, str], left: str, right: str) -> dict[str, Sequence[str]]:
    """{"hip": "hip_{}"} to {"l_hip": ["hip_l"], "r_hip": ["hip_r"]} with the source's words."""
    return {
        f"{side}_{joint}": [pattern.format(word)]
        for side, word in (("l", left), ("r", right))
        for joint, pattern in parts.items()
    }


_MEDIAPIPE = (
    "nose",
    *(f"{s}_eye_{p}" for s in ("left", "right") for p in ("inner", "middle", "outer")),
    "left_ear", "right_ear", "mouth_left", "mouth_right",
    *(f"{s}_{p}" for p in ("shoulder", "elbow", "wrist", "pinky", "index", "thumb",
                           "hip", "knee", "ankle", "heel", "foot_index")
      for s in ("left", "right")),
)  # fmt: skip

_ARM_L = ("clavicle_l", "shoulder_l", "elbow_l", "wrist_l", "hand_l", "handtip_l", "thumb_l")
_LEG_L = ("hip_l", "knee_l", "ankle_l", "foot_l")
_K4ABT = (
    "pelvis", "spine_navel", "spine_chest", "neck",
    *_ARM_L, *(n[:-1] + "r" for n in _ARM_L),
    *_LEG_L, *(n[:-1] + "r" for n in _LEG_L),
    "head", "nose", "eye_l", "ear_l", "eye_r", "ear_r",
)  # fmt: skip

_KINECT2_LIMBS = (("shoulder", "elbow", "wrist", "hand"), ("hip", "knee", "ankle", "foot"))
_KINECT2 = (
    "spine_base", "spine_mid", "neck", "head",
    *(f"{j}_{s}" for limb in _KINECT2_LIMBS for s in ("left", "right") for j in limb),
    "spine_shoulder",
    "hand_tip_left", "thumb_left", "hand_tip_right", "thumb_right",
)  # fmt: skip

_LIMBS = {j: j + "_{}" for j in ("shoulder", "elbow", "wrist", "hip", "knee", "ankle")}

SKELETONS: dict[str, SourceSkeleton] = {
    "studio": SourceSkeleton(
        name="studio", joints=JOINTS, axes=AXES_STUDIO, weights=np.eye(NUM_JOINTS)
    ),
    "mediapipe": skeleton_of(
        "mediapipe",
        _MEDIAPIPE,
        AXES_CAMERA_Y_DOWN,
        {
            **_sided({j: "{}_" + j for j in _LIMBS} | {"toe": "{}_foot_index"}, "left", "right"),
            "head": ["left_ear", "right_ear"],
        },
    ),
    # Azure Kinect: 0 none, 1 low (guessed), 2 medium, 3 high; today's SDK never says more than 2.
    "k4abt": skeleton_of(
        "k4abt",
        _K4ABT,
        AXES_CAMERA_Y_DOWN,
        {**_sided(_LIMBS | {"toe": "foot_{}"}, "l", "r"), "head": ["head"]},
        full_confidence=2.0,
    ),
    # Kinect v2: 0 not tracked, 1 inferred, 2 tracked.
    "kinect2": skeleton_of(
        "kinect2",
        _KINECT2,
        AXES_KINECT2,
        {**_sided(_LIMBS | {"toe": "foot_{}"}, "left", "right"), "head": ["head"]},
        full_confidence=2.0,
    ),
}
"""The skeletons a human frame may name (docs/contract.md)."""


def skeleton(name: str) -> SourceSkeleton:
    """The registered skeleton `name`; StudioError listing the known ones otherwise."""
    if name not in SKELETONS:
        raise unknown_name("skeleton", name, SKELETONS)
    return SKELETONS[name]
