"""HumanPose → the same motion on the template's body, facing +x: what every network sees.

Only the directions of the bones are taken from the person; lengths are the template's, so that
a child, a giant and a tracker that sees everybody 10 % small give the same numbers.
"""

import math

import numpy as np
from numpy.typing import NDArray

from studio.human.posture import SEEN
from studio.human.skeleton import (
    BONE_CHILD,
    BONE_LENGTH,
    BONE_PARENT,
    CHAIN,
    INDEX,
    NUM_BONES,
    NUM_JOINTS,
)

Array = NDArray[np.float64]

FLIP_Y: Array = np.array([1.0, -1.0, 1.0])
ANKLES = np.array([INDEX["l_ankle"], INDEX["r_ankle"]])

# bones = DIFFERENCE @ joints; joints relative to the pelvis = SCALED_CHAIN @ directions
DIFFERENCE: Array = np.zeros((NUM_BONES, NUM_JOINTS))
DIFFERENCE[np.arange(NUM_BONES), BONE_CHILD] = 1.0
DIFFERENCE[np.arange(NUM_BONES), BONE_PARENT] = -1.0
SCALED_CHAIN: Array = CHAIN * BONE_LENGTH


def heading_axes(heading: float) -> Array:
    """(3, 3) rotation R with row_vector_in_heading_frame = row_vector_w @ R."""
    c, s = math.cos(heading), math.sin(heading)
    return np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])


def bone_directions(
    joint_pos_w: Array, confidence: Array
) -> tuple[Array, Array, NDArray[np.bool_]]:
    """Unit bone directions (18, 3) in the source's world, lengths (18,) m, seen (18,).

    A bone is seen when both its joints are and it has a length; others come back as zeros.
    """
    bones = DIFFERENCE @ joint_pos_w
    length = np.sqrt(np.einsum("bi,bi->b", bones, bones))
    sure = confidence >= SEEN
    seen = sure[BONE_CHILD] & sure[BONE_PARENT] & (length > 1e-3)
    return bones * (seen / np.maximum(length, 1e-3))[:, None], length, seen


def rebuild(direction: Array) -> Array:
    """Joints (..., 19, 3) m relative to the pelvis of unit bone directions (..., 18, 3)."""
    return SCALED_CHAIN @ direction
