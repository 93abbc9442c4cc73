"""The Unitree A1 in numbers, declared once: names, order, limits, geometry, gains, stances.

Sources: Unitree's URDF as shipped by the registry package `example-robot-data`
(robots/a1_description/urdf/a1.urdf); tests compare every figure with the compiled model.
Angles in rad, lengths in m, masses in kg, torque in N m, speed in rad/s.
"""

import numpy as np

from studio.timing import CONTROL_DT as CONTROL_DT
from studio.timing import CONTROL_HZ as CONTROL_HZ

LEGS: tuple[str, ...] = ("FR", "FL", "RR", "RL")
LEG_JOINTS: tuple[str, ...] = ("hip", "thigh", "calf")
JOINTS: tuple[str, ...] = tuple(f"{leg}_{joint}" for leg in LEGS for joint in LEG_JOINTS)
NUM_JOINTS = 12
MIRROR_LEG = np.array([1, 0, 3, 2])
"""(4,) each leg's counterpart in the mirror: FR<->FL, RR<->RL."""
MIRROR_JOINT = (3 * MIRROR_LEG[:, None] + np.arange(3)).ravel()
MIRROR_SIGN = np.tile([-1.0, 1.0, 1.0], 4)
"""(12,) each joint's counterpart, and its sign: hip roll turns over, thigh and calf do not."""

HIP_OFFSET = np.array(
    [[0.1805, -0.047, 0.0], [0.1805, 0.047, 0.0], [-0.1805, -0.047, 0.0], [-0.1805, 0.047, 0.0]]
)
"""(4, 3) hip joint of each leg in the trunk frame."""
SIDE = np.array([-1.0, 1.0, -1.0, 1.0])
"""(4,) sign of y: right legs -1, left legs +1."""
THIGH_OFFSET = 0.0838
"""From hip axis to leg plane along the hip's y, times SIDE."""
THIGH_LENGTH = 0.2
CALF_LENGTH = 0.2
FOOT_RADIUS = 0.02

TOTAL_MASS = 13.74
GRAVITY = 9.81
JOINT_LOWER = np.tile([-0.8028514559173915, -1.0471975511965976, -2.6965336943312392], 4)
JOINT_UPPER = np.tile([0.8028514559173915, 4.1887902047863905, -0.9162978572970231], 4)
TORQUE_LIMIT = np.full(12, 33.5)
SPEED_LIMIT = np.full(12, 21.0)

KP = 80.0
KD = 2.0
"""PD gains, N m/rad and N m s/rad, with ARMATURE: a good start for imitation (docs/paper.md)."""
ARMATURE = 0.01

STAND_HEIGHT = 0.27
"""Height of the trunk's origin above the floor in neutral standing."""
STAND_JOINT_POS = np.tile([0.0, 0.895665, -1.791330], 4)
"""Neutral stand: each foot straight under its thigh joint, sole on the floor:
0.4 * cos(0.895665) = 0.25 = STAND_HEIGHT - FOOT_RADIUS."""

LINKS: tuple[str, ...] = ("trunk", *(f"{leg}_{part}" for leg in LEGS for part in LEG_JOINTS))
"""The 13 moving links; each foot is part of its calf."""
NUM_LINKS = len(LINKS)

TRUNK_MASS, HIP_MASS, THIGH_MASS, CALF_MASS, FOOT_MASS = 6.001, 0.696, 1.013, 0.166, 0.06
LINK_MASS = np.array([TRUNK_MASS, *([HIP_MASS, THIGH_MASS, CALF_MASS + FOOT_MASS] * 4)])
"""(13,) order of LINKS: the trunk with its IMU, each calf with its foot."""

_CALF_COM = np.array([0.006435, 0.0, -0.107388]) * CALF_MASS
_CALF_COM = (_CALF_COM + np.array([0.0, 0.0, -CALF_LENGTH]) * FOOT_MASS) / (CALF_MASS + FOOT_MASS)
LEG_COM = np.array(
    [
        [
            [-0.003311 * np.sign(HIP_OFFSET[i, 0]), 0.000635 * SIDE[i], 3.1e-05],
            [-0.003237, -0.022327 * SIDE[i], -0.027326],
            _CALF_COM,
        ]
        for i in range(4)
    ]
)
"""(4, 3, 3) centre of mass of hip, thigh and calf, each in its own link's frame."""
TRUNK_COM = np.array([0.0, 0.0041, -0.0005]) * 6.0 / TRUNK_MASS

# Collision capsules, close to the URDF's boxes and cylinders: radius of each, m. The trunk is two
# capsules along x; the hip reaches along y to the thigh; the foot is a sphere at the calf's end.
TRUNK_RADIUS = 0.057
TRUNK_CAPSULE_Y = 0.04
TRUNK_CAPSULE_X = 0.0765
HIP_RADIUS = 0.041
HIP_CAPSULE_LENGTH = 0.081
THIGH_RADIUS = 0.017
CALF_RADIUS = 0.01
