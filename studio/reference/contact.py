"""Foot positions over time to contact labels: how surely each foot stands, by height and speed.

The paper fixes the corners (1 at height 0 and speed 0, 0 above 2 cm and 60 cm/s); between them

    label = smoothstep(1 - h / 2 cm) * smoothstep(1 - v / 60 cm/s)

with h the height of the sole above the floor and v the speed of the foot in the world.
"""

import numpy as np
from numpy.typing import ArrayLike, NDArray

from studio.geometry.time_scaling import smoothstep
from studio.reference.motion import backward_difference
from studio.robot import a1

Array = NDArray[np.float64]

HEIGHT = 0.02
"""m: above it a foot is in the air."""
SPEED = 0.60
"""m/s: above it a foot is not standing."""


def contact_label(sole_height: ArrayLike, speed: ArrayLike) -> Array:
    """Label (...) in [0, 1] of soles at height (...) m moving at (...) m/s; below floor is 0."""
    height = np.asarray(sole_height, dtype=np.float64)
    return smoothstep(1.0 - height / HEIGHT) * smoothstep(1.0 - np.asarray(speed) / SPEED)


def contact_labels(foot_pos_w: Array, dt: float) -> Array:
    """Labels (T, 4) of foot centres (T, 4, 3) m in the world, a row every dt s.

    Speeds by backward differences.
    """
    speed = np.linalg.norm(backward_difference(foot_pos_w, dt), axis=-1)
    return contact_label(foot_pos_w[..., 2] - a1.FOOT_RADIUS, speed)
