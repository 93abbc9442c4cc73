"""Many instances of one shape in the view, moved by ONE message a frame.

viser's handles send a message for each property that is set, with checks that cost more than the
sending; forty bodies thirty times a second is where that shows. So the message is made here, from
viser's own class (private: tests/web/test_web_viser_canary.py).
"""

import numpy as np
import viser
from numpy.typing import ArrayLike, NDArray
from viser import _messages

from studio.web.shapes import Mesh

HIDDEN = 1e-4
"""Scale of what is not to be seen (zero would leave normals undefined)."""


def linear(srgb: ArrayLike) -> NDArray[np.uint8]:
    """sRGB (..., 3) of 0 to 255 as linear light, which viser's batched meshes take colours for."""
    c = np.asarray(srgb, dtype=np.float64) / 255.0
    light = np.where(c <= 0.04045, c / 12.92, ((c + 0.055) / 1.055) ** 2.4)
    return np.round(255.0 * light).astype(np.uint8)


class Batch:
    """`n` instances of a mesh, unseen until first moved. One thread only."""

    def __init__(
        self,
        scene: viser.SceneApi,
        name: str,
        mesh: Mesh,
        n: int,
        color: ArrayLike,
        *,
        scaled: bool = False,
        scales: ArrayLike | None = None,
        opacity: float | None = None,
        opacities: ArrayLike | None = None,
        shadow: bool = True,
    ) -> None:
        """color: sRGB, (3,) or (n, 3). scaled: `move` will give scales too. scales (n, 3): for
        good. opacities: (n,), and `move` will give them too."""
        if scaled:
            scales = np.full((n, 3), HIDDEN)
        handle = scene.add_batched_meshes_simple(
            name,
            mesh.vertices,
            mesh.faces,
            np.tile([1.0, 0.0, 0.0, 0.0], (n, 1)),
            np.tile([0.0, 0.0, -50.0], (n, 1)),
            batched_scales=None if scales is None else np.asarray(scales),
            batched_colors=linear(color),
            opacity=opacity,
            batched_opacities=None if opacities is None else np.asarray(opacities),
            lod="off",
            cast_shadow=shadow,
        )
        self.name, self.n = handle.name, n
        self._scene = scene

    def move(
        self,
        position: ArrayLike,
        wxyz: ArrayLike | None = None,
        scale: ArrayLike | None = None,
        color: ArrayLike | None = None,
        opacity: ArrayLike | None = None,
    ) -> None:
        """position (n, 3) m, wxyz (n, 4), scale (n, 3), color (n, 3) sRGB, opacity (n,): always the
        same set."""
        updates: dict[str, NDArray] = {"batched_positions": np.array(position, dtype=np.float32)}
        if wxyz is not None:
            updates["batched_wxyzs"] = np.array(wxyz, dtype=np.float32)
        if scale is not None:
            updates["batched_scales"] = np.array(scale, dtype=np.float32)
        if color is not None:
            updates["batched_colors"] = linear(color)
        if opacity is not None:
            updates["batched_opacities"] = np.array(opacity, dtype=np.float32)
        self._scene._queue_scene_message(_messages.SceneNodeUpdateMessage(self.name, updates))
