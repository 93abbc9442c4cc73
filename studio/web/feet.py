"""Under a robot's feet: a disc that says whether each stands, and the shadow it throws."""

import numpy as np
import viser
from numpy.typing import NDArray

from studio.robot import a1
from studio.web import shapes
from studio.web.scene_batch import Batch

Array = NDArray[np.float64]

CONTACT_ON = np.array([46, 204, 130], dtype=np.float64)
CONTACT_OFF = np.array([120, 128, 145], dtype=np.float64)
CONTACT_RADIUS = 0.036
SOLE_UNDER = a1.FOOT_RADIUS - 0.002
"""m from a foot's centre down to its disc."""
SHADOW_RADIUS, SHADOW_COLOR, SHADOW = 0.06, (8, 10, 16), 0.5
"""m, sRGB, and opacity, of a foot's shadow where it stands."""
SHADOW_FADES = 0.12
"""m: so high, a foot throws a third of that shadow, half as wide again."""


class Feet:
    """Discs and shadows of one robot's four feet. One thread."""

    def __init__(self, scene: viser.SceneApi, figure: str) -> None:
        disc = shapes.disc_mesh()
        self._shadows = Batch(
            scene, f"/{figure}/shadows", disc, 4, SHADOW_COLOR,
            scaled=True, opacity=1.0, opacities=np.zeros(4), shadow=False,
        )  # fmt: skip
        colors = np.tile(CONTACT_OFF, (4, 1))
        self._contacts = Batch(
            scene, f"/{figure}/contacts", disc, 4, colors, scaled=True, shadow=False
        )

    def update(self, feet: Array, contact: Array) -> None:
        """Feet (4, 3) m in the view; contact (4,) in [0, 1]."""
        contact = np.clip(contact, 0.0, 1.0)[:, None]
        # On the floor; where one stands, just over its sole, which may be on a step.
        under = np.where(contact[:, 0] > 0.5, feet[:, 2] - SOLE_UNDER, 0.0).clip(min=0.002)
        high = (feet[:, 2] - SOLE_UNDER - under).clip(min=0.0) / SHADOW_FADES
        at = feet.copy()
        at[:, 2] = under
        radius = CONTACT_RADIUS * (0.55 + 0.45 * contact)
        color = CONTACT_OFF + contact * (CONTACT_ON - CONTACT_OFF)
        self._contacts.move(at, scale=np.tile(radius, (1, 3)), color=color)
        at[:, 2] -= 0.001
        wide = SHADOW_RADIUS * (1.0 + 0.5 * high)
        flat = np.column_stack([wide, wide, np.full(4, 0.001)])
        self._shadows.move(at, scale=flat, opacity=SHADOW * np.exp(-high))
