"""The formulas of `studio.geometry`, by component, each written once.

On plain floats, for the control loop's innermost steps: on one value they are ten times quicker
than small arrays. On components with batch axes, arrays or tensors alike: `studio.geometry` and
`studio.training.mapper_net` stack what comes out. Quaternions are (w, x, y, z), vectors (x, y, z);
frames as in `studio.geometry`.
"""

import math
from collections.abc import Sequence
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Quat = Sequence[float]
Vec = tuple[float, float, float]
Matrix = tuple[Vec, Vec, Vec]
Part = TypeVar("Part", float, Array)
"""A component: one number, or an array of any shape; a tensor does as well."""


def mul(a: Sequence[Part], b: Sequence[Part]) -> tuple[Part, Part, Part, Part]:
    """Hamilton product of two wxyz quaternions: R_a_c = R_a_b R_b_c."""
    aw, ax, ay, az = a
    bw, bx, by, bz = b
    return (
        aw * bw - ax * bx - ay * by - az * bz,
        aw * bx + ax * bw + ay * bz - az * by,
        aw * by - ax * bz + ay * bw + az * bx,
        aw * bz + ax * by - ay * bx + az * bw,
    )


def conj(q: Quat) -> tuple[float, float, float, float]:
    """The inverse of a unit quaternion: R_b_a of R_a_b."""
    w, x, y, z = q
    return (w, -x, -y, -z)


def yaw(angle: float) -> tuple[float, float, float, float]:
    """The rotation by `angle` rad about z."""
    return (math.cos(0.5 * angle), 0.0, 0.0, math.sin(0.5 * angle))


def turn_xy(x: float, y: float, angle: float) -> tuple[float, float]:
    """A vector turned to the left by `angle` rad about z."""
    c, s = math.cos(angle), math.sin(angle)
    return c * x - s * y, s * x + c * y


def row_x(q: Sequence[Part]) -> tuple[Part, Part, Part]:
    """The first row of the rotation matrix of a unit quaternion R_a_b: a's x axis seen from b."""
    w, x, y, z = q
    return (1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y))


def row_y(q: Sequence[Part]) -> tuple[Part, Part, Part]:
    """The second row: a's y axis seen from b."""
    w, x, y, z = q
    return (2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x))


def row_z(q: Sequence[Part]) -> tuple[Part, Part, Part]:
    """The third row: a's z axis seen from b."""
    w, x, y, z = q
    return (2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y))


def rows(q: Quat) -> Matrix:
    """The rows of the rotation matrix of a unit quaternion: v_a = R v_b."""
    return row_x(q), row_y(q), row_z(q)


def matrix(q: Quat) -> Array:
    """(3, 3) rotation matrix: v_a = matrix(q) @ v_b; rows of vectors (N, 3) @ matrix(q).T."""
    return np.array(rows(q))


def dot(u: Sequence[Part], v: Sequence[Part]) -> Part:
    """Scalar product of two vectors in the same frame."""
    return u[0] * v[0] + u[1] * v[1] + u[2] * v[2]


def turn(q: Sequence[Part], v: Sequence[Part]) -> tuple[Part, Part, Part]:
    """R v, with R as its unit quaternion: v_a = R_a_b v_b."""
    # v + w t + u x t with t = 2 u x v
    w, x, y, z = q
    vx, vy, vz = v
    tx, ty, tz = 2.0 * (y * vz - z * vy), 2.0 * (z * vx - x * vz), 2.0 * (x * vy - y * vx)
    return (
        vx + w * tx + (y * tz - z * ty),
        vy + w * ty + (z * tx - x * tz),
        vz + w * tz + (x * ty - y * tx),
    )


def rotate(r: Matrix, v: Sequence[float]) -> Vec:
    """R v, with R as its rows: v_a = R_a_b v_b."""
    x, y, z = v
    (a, b, c), (d, e, f), (g, h, i) = r
    return a * x + b * y + c * z, d * x + e * y + f * z, g * x + h * y + i * z


def rotate_back(r: Matrix, v: Sequence[float]) -> Vec:
    """R^T v, with R as its rows: v_b = R_b_a v_a."""
    x, y, z = v
    (a, b, c), (d, e, f), (g, h, i) = r
    return a * x + d * y + g * z, b * x + e * y + h * z, c * x + f * y + i * z


def rotvec(q: Quat) -> tuple[float, float, float]:
    """Rotation vector (rad) of a unit quaternion R_a_b, the short way: the same in a and b."""
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
    """The sum of two points or vectors in the same frame."""
    return a[0] + b[0], a[1] + b[1], a[2] + b[2]


def mean_gap(a: Sequence[Sequence[float]], b: list[Vec], rows: list[int]) -> list[float]:
    """(3,) mean of a - b over some rows of two lists of points in the same frame."""
    return [sum([a[i][k] - b[i][k] for i in rows]) / len(rows) for k in range(3)]


def no_further(point: list[float], before: list[float], step: float) -> list[float]:
    """A point (3,) drawn back to no further than `step` from where it was, in the same unit."""
    way = math.dist(point, before)
    if way <= step:
        return point
    return [b + (a - b) * (step / way) for a, b in zip(point, before, strict=True)]
