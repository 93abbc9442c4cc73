"""Poses alone → what an expert says: contacts by height, rates by the difference over 0.1 s.

Methods that map poses (Dontcheva, Yamane, Seol, GMR) know neither contacts nor velocities; the
root's are told by the feet that stand, as the labels' are by the motion.
"""

from collections import deque

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.features import DELTA_FRAMES, FEATURE_DIM
from studio.human.skeleton import BONES
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL, fit_plane
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.simple import THRESHOLD
from studio.retarget.mapper import NUM_RATES, RATES, Mapped
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

NUM_POSE = 15
"""A pose as numbers: 12 joints (rad) and the trunk's turn from the state's neutral (rotvec)."""


def pose_rows(state: StateName, pairs: Pairs) -> Array:
    """(N, 15) the robot's poses of pairs."""
    quat = geometry.normalize(np.asarray(pairs.base_quat, np.float64))
    turned = geometry.quat_mul(quat, geometry.quat_conj(NEUTRAL[state].base_quat))
    vec = geometry.quat_to_rotvec(geometry.quat_positive(turned))
    return np.concatenate([np.asarray(pairs.joint_pos, np.float64), vec], axis=1)


def trunk_of(state: StateName, rotvec: Array) -> Array:
    """Trunk orientation (..., 4) of a turn (..., 3) from the state's neutral."""
    return geometry.quat_mul(geometry.quat_from_rotvec(rotvec), NEUTRAL[state].base_quat)


def columns_of(*parts: str) -> NDArray[np.intp]:
    """Where the joints of names that end in one of `parts` lie in q; "height" is one of them."""
    chosen = [
        3 * k + axis for k, bone in enumerate(BONES) if bone.endswith(parts) for axis in range(3)
    ]
    return np.array([*chosen, *([FEATURE_DIM - 1] if "height" in parts else [])])


class Moving:
    """Remembers the poses of the last 0.1 s. One thread."""

    def __init__(self, state: StateName) -> None:
        self._state: StateName = state
        self._past: deque[tuple[Array, Array, NDArray[np.bool_]]] = deque(maxlen=DELTA_FRAMES + 1)

    def step(self, pose: Array) -> Mapped:
        """The next control period's pose (15,), joints held to their limits."""
        joints = np.clip(pose[:12], a1.JOINT_LOWER, a1.JOINT_UPPER)
        quat = trunk_of(self._state, pose[12:])
        feet = kinematics.foot_pos_w(np.zeros(3), quat, joints)
        down = feet[:, 2] - feet[:, 2].min() <= THRESHOLD
        self._past.append((joints, feet, down))
        rates = np.zeros(NUM_RATES)
        before, feet_before, down_before = self._past[0]
        span = max(len(self._past) - 1, 1) * a1.CONTROL_DT
        rates[RATES["joint_vel"]] = (joints - before) / span
        stood = down & down_before
        if stood.any():
            # The floor stands still: what its feet do, the trunk does the other way.
            moved = (feet[stood] - feet_before[stood]).mean(axis=0)
            rates[RATES["base_lin_vel"]] = -moved / span
            if self._state == "walk" and stood.sum() > 1:
                yaw = fit_plane(feet_before[stood, :2], feet[stood, :2])[1]
                up = geometry.quat_rotate_inverse(quat, np.array([0.0, 0.0, 1.0]))
                rates[RATES["base_ang_vel"]] = -yaw / span * up
        return Mapped(
            joint_pos=joints, base_quat=quat, rates=rates, contact_prob=down.astype(np.float64)
        )
