"""After GMR: no learning; hands, feet and chest become targets of an optimisation in task space.

Source: J. P. Araújo, Y. Ze, P. Xu, J. Wu, C. K. Liu, "Retargeting Matters: General Motion
Retargeting for Humanoid Motion Tracking", 2025: bodies are matched by name, scaled each for itself,
and a robot's inverse kinematics follows positions and orientations of different weight.

Kept: the matching, scales for each limb, weights, and the solver's damped Gauss-Newton steps from
the last pose. Matched are the hands to the front feet, the feet to the rear ones and the chest to
the trunk, each by how far it is from where it rests. Not kept: their first stage for a human-like
root, and `mink`; the A1's Jacobians are closed form here.

Input: one pair, how a person holds themselves while the robot rests; who squats unlike them is
read as leaning. Limits: it says where a body is, not what is meant: who marches lifts the rear feet
alone and goes nowhere.
"""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.features import FEATURE_DIM, HEIGHT, joints_of
from studio.human.skeleton import INDEX, LEG_LENGTH
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL, NEUTRAL_FEET
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.moving import Moving, pose_rows, trunk_of
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

ARM, LEG, HEIGHT_SCALE = 0.45, 0.32, 0.32
"""The robot's way for a person's of 1 m: paws for hands, rear feet for feet, trunk for pelvis."""
FOOT_WEIGHTS, TURN_WEIGHT, PLACE_WEIGHT = (3.0, 3.0, 10.0, 10.0), 3.0, (1.0, 1.0, 5.0)
"""1/m of feet (hands count less), 1/rad of the trunk's turn, 1/m of its place along, aside, up."""
DAMPING = 0.02
"""1/rad: joints stay where they are unless there is a reason."""
STEPS = 4
"""Gauss-Newton steps a control period."""
RESTING = 20
"""Frames at which the robot is nearest to rest, whose person is taken for the resting one."""
_HANDS = np.array([INDEX["r_wrist"], INDEX["l_wrist"]])
_SHOULDERS = np.array([INDEX["r_shoulder"], INDEX["l_shoulder"]])
_FEET = np.array([INDEX["r_ankle"], INDEX["l_ankle"]])


class Gmr(FrameByFrame):
    """A state's expert. rest (F,): q of a person while the robot rests."""

    def __init__(self, state: StateName, rest: Array) -> None:
        self.state: StateName = state
        self.rest = rest
        self._hands, self._feet, self._chest = _bodies(rest)

    @classmethod
    def fit(cls, state: StateName, pairs: Pairs, seed: int = 0) -> "Gmr":
        """Only the resting person is looked for."""
        del seed
        neutral = np.append(NEUTRAL[state].joint_pos, np.zeros(3))
        far = np.sum((pose_rows(state, pairs) - neutral) ** 2, axis=1)
        nearest = np.argsort(far, kind="stable")[:RESTING]
        q = np.asarray(pairs.triplet[nearest, :FEATURE_DIM], np.float64)
        return cls(state, np.median(q, axis=0))

    def targets(self, q: Array) -> tuple[Array, Array, Array]:
        """Feet (4, 3) m and trunk's place (3,) and orientation (4,), the state's frame, for a
        person (F,)."""
        neutral, feet = NEUTRAL[self.state], NEUTRAL_FEET[self.state].copy()
        hands, ankles, chest = _bodies(q)
        feet[:2] += ARM * (hands - self._hands)
        feet[2:] += LEG * (ankles - self._feet)
        feet[:, 2] = np.maximum(feet[:, 2], a1.FOOT_RADIUS)
        place = neutral.base_pos.copy()
        place[2] += HEIGHT_SCALE * LEG_LENGTH * (q[HEIGHT] - self.rest[HEIGHT])
        turned = geometry.quat_from_matrix(chest @ self._chest.T)
        return feet, place, geometry.quat_mul(turned, neutral.base_quat)

    def begin(self) -> Callable[[NDArray], Mapped]:
        """Start anew from rest."""
        neutral, moving = NEUTRAL[self.state], Moving(self.state)
        place, turn, joints = neutral.base_pos, np.zeros(3), neutral.joint_pos

        def step(triplet: NDArray) -> Mapped:
            nonlocal place, turn, joints
            wanted = self.targets(np.asarray(triplet[:FEATURE_DIM], np.float64))
            place, turn, joints = self.solve(place, turn, joints, *wanted)
            return moving.step(np.append(joints, turn))

        return step

    def solve(
        self, place: Array, turn: Array, joints: Array, feet: Array, to: Array, facing: Array
    ) -> tuple[Array, Array, Array]:
        """Place (3,), turn from neutral (3,) and joints (12,), STEPS nearer to their targets."""
        for _ in range(STEPS):
            quat = trunk_of(self.state, turn)
            rotation = geometry.quat_to_matrix(quat)
            arms = kinematics.foot_pos_b(joints) @ rotation.T
            jacobian, error = np.zeros((30, 18)), np.zeros(30)
            legs = rotation @ kinematics.leg_jacobian(joints)
            for leg, weight in enumerate(FOOT_WEIGHTS):
                rows, x = slice(3 * leg, 3 * leg + 3), arms[leg]
                jacobian[rows, :3] = weight * np.eye(3)
                jacobian[rows, 3:6] = -weight * _cross(x)
                jacobian[rows, 6 + 3 * leg : 9 + 3 * leg] = weight * legs[leg]
                error[rows] = weight * (feet[leg] - place - x)
            jacobian[12:15, :3] = np.diag(PLACE_WEIGHT)
            error[12:15] = PLACE_WEIGHT * (to - place)
            away = geometry.quat_mul(facing, geometry.quat_conj(quat))
            jacobian[15:18, 3:6] = TURN_WEIGHT * np.eye(3)
            error[15:18] = TURN_WEIGHT * geometry.quat_to_rotvec(geometry.quat_positive(away))
            jacobian[18:, 6:] = DAMPING * np.eye(12)
            step = np.linalg.solve(jacobian.T @ jacobian + 1e-6 * np.eye(18), jacobian.T @ error)
            place = place + step[:3]
            turned = geometry.quat_mul(geometry.quat_from_rotvec(step[3:6]), quat)
            back = geometry.quat_mul(turned, geometry.quat_conj(NEUTRAL[self.state].base_quat))
            turn = geometry.quat_to_rotvec(geometry.quat_positive(back))
            joints = np.clip(joints + step[6:], a1.JOINT_LOWER, a1.JOINT_UPPER)
        return place, turn, joints


def _bodies(q: Array) -> tuple[Array, Array, Array]:
    """Hands from the shoulders, feet from the pelvis' foot on the floor (2, 3) m, right first, and
    the chest's axes (3, 3), of a person (F,)."""
    joints = joints_of(q)
    up = geometry.normalize(joints[INDEX["chest"]] - joints[INDEX["pelvis"]])
    left = joints[INDEX["l_shoulder"]] - joints[INDEX["r_shoulder"]]
    left = geometry.normalize(left - (left @ up) * up)
    axes = np.stack([np.cross(left, up), left, up], axis=1)
    return joints[_HANDS] - joints[_SHOULDERS], joints[_FEET], axes


def _cross(v: Array) -> Array:
    x, y, z = v
    return np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
