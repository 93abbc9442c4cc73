"""Single rotations and points as plain floats: ten times quicker on one than small arrays.

The same conventions and results as `studio.geometry`, for the control loop's innermost steps.
"""

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Quat = Sequence[float]
Vec = tuple[float, float, float]
Matrix = tuple[Vec, Vec, Vec]


def mul(a: Quat, b: Quat) -> tuple[float, float, float, float]:
    """Hamilton product of two wxyz quaternions."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def conj(q: Quat) -> tuple[float, float, float, float]:
    """The inverse of a unit quaternion."""
    w, x, y, z = q
    return (w, -x, -y, -z)


def yaw(angle: float) -> tuple[float, float, float, float]:
    """The rotation by `angle` rad about z."""
    return (math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle))


def rows(q: Quat) -> Matrix:
    """The rows of the rotation matrix of a unit quaternion: v_a = R v_b."""
    w, x, y, z = q
    return (
        (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)),
        (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)),
        (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)),
    )


def matrix(q: Quat) -> Array:
    """(3, 3) rotation matrix: v_a = matrix(q) @ v_b; rows of vectors (N, 3) @ matrix(q).T."""
    return np.array(rows(q))


def rotate(r: Matrix, v: Sequence[float]) -> Vec:
    """R v, with R as its rows."""
    x, y, z = v
    (a, b, c), (d, e, f), (g, h, i) = r
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def rotate_back(r: Matrix, v: Sequence[float]) -> Vec:
    """R^T v, with R as its rows."""
    x, y, z = v
    (a, b, c), (d, e, f), (g, h, i) = r
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


def rotvec(q: Quat) -> tuple[float, float, float]:
    """Rotation vector (rad) of a unit quaternion, the short way."""
    w, x, y, z = q
    if w < 0.0:
        w, x, y, z = -w, -x, -y, -z
    s = math.sqrt(x * x + y * y + z * z)
    scale = 2.0 * math.atan2(s, w) / s if s > 1e-12 else 2.0
    return (scale * x, scale * y, scale * z)


def from_rotvec(r: Sequence[float]) -> tuple[float, float, float, float]:
    """Unit quaternion of a rotation vector (rad)."""
    x, y, z = r
    angle = math.sqrt(x * x + y * y + z * z)
    s = math.sin(0.5 * angle) / angle if angle > 1e-12 else 0.5
    return (math.cos(0.5 * angle), s * x, s * y, s * z)


def add(a: Sequence[float], b: Sequence[float]) -> Vec:
    """The sum of two points."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def mean_gap(a: Sequence[Sequence[float]], b: list[Vec], rows: list[int]) -> list[float]:
    """(3,) mean of a - b over some rows of two lists of points."""
    return [sum([a[i][k] - b[i][k] for i in rows]) / len(rows) for k in range(3)]


def no_further(point: list[float], before: list[float], step: float) -> list[float]:
    """A point (3,) drawn back to no further than `step` from where it was."""
    way = math.dist(point, before)
    if way <= step:
        return point
    return [b + (a - b) * (step / way) for a, b in zip(point, before, strict=True)]
