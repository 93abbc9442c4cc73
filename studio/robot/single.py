"""One pose's legs in plain floats: the closed forms of `legs`, ten times quicker than small arrays.

`legs.foot_pos_b` and `legs.leg_ik` come here with a single pose, as the control loop does in every
period; batches stay vectorised. The same equations and results.
"""

import math
from collections.abc import Sequence
from math import acos, atan2, cos, pi, sin, sqrt

from studio.robot import a1

Point = tuple[float, float, float]

_L1, _L2 = a1.THIGH_LENGTH, a1.CALF_LENGTH
_TWO_PI = 2.0 * pi
_LEGS = tuple(
    (*hip, side)
    for hip, side in zip(a1.HIP_OFFSET.tolist(), (a1.SIDE * a1.THIGH_OFFSET).tolist(), strict=True)
)
_LOWER, _UPPER = a1.JOINT_LOWER[:3].tolist(), a1.JOINT_UPPER[:3].tolist()  # all legs' are the same
(_HIP_MIN, _THIGH_MIN, _CALF_MIN), (_HIP_MAX, _THIGH_MAX, _CALF_MAX) = _LOWER, _UPPER
_THIGH_MIDDLE = 0.5 * (_THIGH_MIN + _THIGH_MAX)
_SAME = 1e-9
"""m; two ways to reach a foot as near as this are equally good."""


def feet(joint_pos: Sequence[float]) -> list[Point]:
    """The four foot centres in the base frame, m, of twelve joint angles."""
    out = []
    for i, (hx, hy, hz, offset) in enumerate(_LEGS):
        a, b, c = joint_pos[3 * i : 3 * i + 3]
        x = -_L1 * sin(b) - _L2 * sin(b + c)
        z = -_L1 * cos(b) - _L2 * cos(b + c)
        sa, ca = sin(a), cos(a)
        out.append((x + hx, offset * ca - z * sa + hy, offset * sa + z * ca + hz))
    return out


def joints(
    foot_b: Sequence[Sequence[float]], near_hip: Sequence[float]
) -> tuple[list[float], list[float]]:
    """Twelve joint angles and four errors (m) of four feet in the base frame, as `legs.leg_ik`."""
    angles: list[float] = []
    errors: list[float] = []
    for (fx, fy, fz), (hx, hy, hz, offset), near in zip(foot_b, _LEGS, near_hip, strict=True):
        x, y, z = fx - hx, fy - hy, fz - hz
        depth = sqrt(max(y * y + z * z - offset * offset, 0.0))
        direction, opening = atan2(z, y), atan2(depth, offset)
        best = _reach(x, y, z, offset, direction + opening)
        other = _hip(direction - opening)
        # Most feet are under their hip, reached exactly by the nearer hip angle: that decides.
        if best[3] >= _SAME or abs(other - near) < abs(best[0] - near):
            best = _better(best, _reach(x, y, z, offset, direction - opening), near)
        angles += best[:3]
        errors.append(best[3])
    return angles, errors


_Way = tuple[float, float, float, float]
"""Hip, thigh and calf angle, and how far from the foot they end."""


def _better(one: _Way, other: _Way, near: float) -> _Way:
    least = min(one[3], other[3]) + _SAME
    cost = (0.0 if one[3] < least else 10.0) + abs(one[0] - near)
    return other if (0.0 if other[3] < least else 10.0) + abs(other[0] - near) < cost else one


def _hip(angle: float) -> float:
    return min(max((angle + pi) % _TWO_PI - pi, _HIP_MIN), _HIP_MAX)


def _reach(x: float, y: float, z: float, offset: float, angle: float) -> _Way:
    """The leg that comes nearest to (x, y, z) m from its hip, with the hip turned to `angle`."""
    hip = _hip(angle)
    sa, ca = sin(hip), cos(hip)
    down = z * ca - y * sa
    cos_calf = (x * x + down * down - _L1**2 - _L2**2) / (2.0 * _L1 * _L2)
    calf = min(max(-acos(min(max(cos_calf, -1.0), 1.0)), _CALF_MIN), _CALF_MAX)
    thigh = atan2(-x, -down) - atan2(_L2 * sin(calf), _L1 + _L2 * cos(calf))
    thigh = (thigh - _THIGH_MIDDLE + pi) % _TWO_PI - pi + _THIGH_MIDDLE
    if not _THIGH_MIN <= thigh <= _THIGH_MAX:
        # The thigh stops: the calf points from the knee towards the target.
        thigh = min(max(thigh, _THIGH_MIN), _THIGH_MAX)
        calf = atan2(-x - _L1 * sin(thigh), -down - _L1 * cos(thigh)) - thigh
        calf = (calf + 0.5 * pi + pi) % _TWO_PI - pi - 0.5 * pi  # into [-3/2 pi, pi/2)
        calf = min(max(calf, _CALF_MIN), _CALF_MAX)
    along = -_L1 * sin(thigh) - _L2 * sin(thigh + calf)
    below = -_L1 * cos(thigh) - _L2 * cos(thigh + calf)
    gap = (along - x, offset * ca - below * sa - y, offset * sa + below * ca - z)
    return hip, thigh, calf, math.hypot(*gap)
