"""Poses → pictures of a clothed mannequin in a room, as a webcam would film the person.

A figure of shaded spheres, drawn in numpy: no graphics library, and the same picture on every
machine. It is what tests of the camera show to the pose model instead of a person.
"""

import io
from collections.abc import Iterable, Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from PIL import Image

from studio.human.skeleton import INDEX

Array = NDArray[np.float64]

SKIN, HAIR, SHIRT, TROUSERS, SHOES = (
    (205, 150, 122), (62, 42, 32), (54, 98, 158), (66, 62, 72), (214, 212, 206),
)  # fmt: skip
WHITE, DARK, LIPS = (236, 232, 228), (40, 30, 30), (158, 78, 78)
_LIGHT = np.array([0.62, 0.35, 0.70]) / np.linalg.norm([0.62, 0.35, 0.70])

# Limbs as tapered rods between joints: m at either end, colour. Short sleeves, long trousers.
_RODS = (
    ("hip", "knee", 0.082, 0.058, TROUSERS),
    ("knee", "ankle", 0.060, 0.044, TROUSERS),
    ("ankle", "toe", 0.046, 0.036, SHOES),
    ("elbow", "wrist", 0.040, 0.029, SKIN),
)
_SLEEVE = 0.55
"""Share of the upper arm that the shirt covers."""


@dataclass(frozen=True, kw_only=True)
class Camera:
    """A webcam at (distance, 0, height) m, looking back along -x at who stands on the origin.

    size: (width, height) px. view: rad, angle between the picture's top and bottom. turn: rad, the
    person is seen from so far to their left.
    """

    distance: float = 3.0
    height: float = 1.0
    size: tuple[int, int] = (640, 480)
    view: float = 0.72
    turn: float = 0.0

    def project(self, points: Array) -> Array:
        """(..., 3) m to (..., 3): px to the right, px down, m away."""
        c, s = np.cos(self.turn), np.sin(self.turn)
        x = c * points[..., 0] + s * points[..., 1]
        y = c * points[..., 1] - s * points[..., 0]
        away = self.distance - x
        focal = 0.5 * self.size[1] / np.tan(0.5 * self.view)
        across = 0.5 * self.size[0] + focal * y / away
        down = 0.5 * self.size[1] - focal * (points[..., 2] - self.height) / away
        return np.stack([across, down, away], axis=-1)


class Mannequin:
    """Draws the synthetic person; `picture` for each pose."""

    def __init__(self, camera: Camera | None = None) -> None:
        self.camera = camera or Camera()
        self._room = _room(self.camera)

    def picture(self, joint_pos_w: Array) -> NDArray[np.uint8]:
        """(height, width, 3) of a pose (19, 3) m; nobody is drawn for one that is not finite."""
        colour = self._room.copy()
        depth = np.full(colour.shape[:2], np.inf)
        if np.isfinite(joint_pos_w).all():
            centres, radii, colours = _spheres(joint_pos_w)
            seen = self.camera.project(centres)
            focal = 0.5 * self.camera.size[1] / np.tan(0.5 * self.camera.view)
            for k in np.argsort(seen[:, 2]):
                _draw(colour, depth, seen[k], focal / seen[k, 2], float(radii[k]), colours[k])
        return np.clip(colour, 0.0, 255.0).astype(np.uint8)


def mjpeg(pictures: Iterable[NDArray[np.uint8]], quality: int = 80) -> Iterator[bytes]:
    """Each picture as a JPEG; joined they are an MJPEG video, without a clock of its own."""
    for picture in pictures:
        file = io.BytesIO()
        Image.fromarray(picture).save(file, "JPEG", quality=quality)
        yield file.getvalue()


def _room(camera: Camera) -> Array:
    """A wall above a floor, a skirting board, and a little of a camera's noise."""
    width, height = camera.size
    horizon = camera.project(np.array([-2.0, 0.0, 0.0]))[1]
    down = np.arange(height, dtype=float)[:, None, None]
    wall = np.array([188.0, 184.0, 174.0]) - 30.0 * down / height
    floor = np.array([128.0, 104.0, 82.0]) + 40.0 * (down - horizon) / height
    room = np.where(down < horizon - 8.0, wall, np.where(down < horizon, 214.0, floor))
    noise = np.random.default_rng(0).normal(0.0, 2.0, (height, width, 1))
    return np.broadcast_to(room, (height, width, 3)) + noise


def _spheres(pose: Array) -> tuple[Array, Array, Array]:
    """Centres (n, 3) m, radii (n,) m and colours (n, 3) that make up the figure."""
    at = {name: pose[k] for name, k in INDEX.items()}
    made: list[tuple[Array, float, tuple[int, int, int]]] = []

    def rod(a: Array, b: Array, ra: float, rb: float, colour: tuple[int, int, int]) -> None:
        count = max(2, round(float(np.linalg.norm(b - a)) / (0.22 * min(ra, rb))))
        for s in np.linspace(0.0, 1.0, count):
            made.append((a + s * (b - a), ra + s * (rb - ra), colour))

    for side in ("l_", "r_"):
        for start, end, ra, rb, colour in _RODS:
            rod(at[side + start], at[side + end], ra, rb, colour)
        shoulder, elbow, wrist = (at[side + j] for j in ("shoulder", "elbow", "wrist"))
        cuff = shoulder + _SLEEVE * (elbow - shoulder)
        rod(shoulder, cuff, 0.060, 0.055, SHIRT)
        rod(cuff, elbow, 0.045, 0.040, SKIN)
        along = _unit(wrist - elbow)
        rod(wrist, wrist + 0.13 * along, 0.033, 0.022, SKIN)
        rod(at[side + "ankle"], at[side + "ankle"] - [0.0, 0.0, 0.04], 0.045, 0.04, SHOES)
    across = _unit(at["l_shoulder"] - at["r_shoulder"])
    for s in np.linspace(0.06, 0.94, 7):  # the trunk: rods from one side of it to the other
        low = at["r_hip"] + s * (at["l_hip"] - at["r_hip"])
        high = at["r_shoulder"] + s * (at["l_shoulder"] - at["r_shoulder"])
        waist = low + 0.25 * (high - low)
        rod(low, waist, 0.100, 0.094, TROUSERS)
        rod(waist, high, 0.094, 0.080, SHIRT)
    rod(at["chest"], at["head"], 0.056, 0.056, SKIN)
    _head(made, at["head"], _unit(at["head"] - at["chest"]), across)
    return (
        np.array([m[0] for m in made]),
        np.array([m[1] for m in made]),
        np.array([m[2] for m in made], dtype=float),
    )


def _head(made: list, middle: Array, up: Array, left: Array) -> None:
    """Skull, hair, and a face that looks to where the shoulders do."""
    front = _unit(np.cross(left, up))

    def put(
        forward: float, side: float, high: float, radius: float, colour: tuple[int, int, int]
    ) -> None:
        made.append((middle + forward * front + side * left + high * up, radius, colour))

    for high, radius in ((0.06, 0.094), (0.03, 0.094), (0.0, 0.090), (-0.03, 0.080)):
        put(0.0, 0.0, high, radius, SKIN)
    put(0.018, 0.0, -0.065, 0.062, SKIN)  # the jaw
    for high in (0.055, 0.075, 0.09):
        put(-0.022, 0.0, high, 0.100, HAIR)
    put(-0.04, 0.0, 0.02, 0.088, HAIR)
    for side in (-1.0, 1.0):
        put(-0.005, 0.094 * side, -0.005, 0.022, SKIN)  # ears
        put(0.077, 0.033 * side, 0.022, 0.0155, WHITE)
        put(0.088, 0.033 * side, 0.022, 0.0080, DARK)
        for step in (-1.0, 0.0, 1.0):  # brows
            put(0.082, 0.033 * side + 0.010 * step, 0.047, 0.0075, HAIR)
    for step in range(5):  # nose
        put(0.080 + 0.006 * step, 0.0, 0.022 - 0.009 * step, 0.011 + 0.001 * step, SKIN)
    for step in range(-3, 4):
        put(0.072 - 0.001 * step * step, 0.007 * step, -0.055, 0.0085, LIPS)


def _draw(
    colour: Array, depth: Array, seen: Array, scale: float, radius: float, paint: Array
) -> None:
    """One sphere over what is farther away; scale: px a metre at its distance."""
    (across, down, away), radius_px = seen, scale * radius
    height, width = depth.shape
    left, right = max(0, int(across - radius_px)), min(width, int(across + radius_px) + 2)
    top, bottom = max(0, int(down - radius_px)), min(height, int(down + radius_px) + 2)
    if left >= right or top >= bottom or away < 0.1:
        return
    y = (np.arange(left, right) - across) / radius_px
    z = (down - np.arange(top, bottom)) / radius_px
    square = 1.0 - z[:, None] ** 2 - y[None, :] ** 2
    x = np.sqrt(np.maximum(square, 0.0))
    near = away - radius * x
    patch = depth[top:bottom, left:right]
    shown = (square > 0.0) & (near < patch)
    lit = x * _LIGHT[0] + y[None, :] * _LIGHT[1] + z[:, None] * _LIGHT[2]
    shade = 0.52 + 0.56 * np.maximum(lit, 0.0)
    patch[shown] = near[shown]
    colour[top:bottom, left:right][shown] = shade[shown][:, None] * paint


def _unit(v: Array) -> Array:
    return v / max(float(np.linalg.norm(v)), 1e-9)
