"""The camera at the robot's front: where it is mounted, and what is in its picture.

It is the one that the page draws as *Its eye*. A RealSense D435, as an A1 carries it, sees 87 by 58
degrees and measures to some 10 m.
"""

import math

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]

MOUNT = np.array([0.29, 0.0, 0.02])
"""(3,) m in the trunk's frame; it looks along the trunk's x, its picture upright along z."""
FOV = math.radians(62.0)
"""rad, from the picture's lower edge to its upper one."""
ASPECT = 1.5
NEAR, FAR = 0.02, 10.0
"""m: what is nearer, or further, is not seen."""


def in_picture(point_b: ArrayLike, share: float = 1.0) -> NDArray[np.bool_]:
    """(...) whether points (..., 3) m of the trunk's frame are in the picture, or in the middle
    `share` of its width and height, if nothing hides them."""
    gap = np.asarray(point_b, dtype=np.float64) - MOUNT
    high = share * math.tan(0.5 * FOV) * gap[..., 0]
    far = np.linalg.norm(gap, axis=-1)
    inside = (np.abs(gap[..., 2]) <= high) & (np.abs(gap[..., 1]) <= ASPECT * high)
    return inside & (gap[..., 0] > NEAR) & (far < FAR)
