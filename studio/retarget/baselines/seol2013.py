"""Seol, O'Sullivan, Lee 2013: features chosen by hand, a map for each, a classifier, nearby clips.

Source: Y. Seol, C. O'Sullivan, J. Lee, "Creature Features: Online Motion Puppetry for Non-Human
Characters", SCA 2013: features of a puppeteer drive those of a creature; which mapping is meant is
classified; the result is coupled to motions that the creature has.

Kept: the pairs of features (FEATURE_PAIRS: what a user would tick), a ridge map for each pair and
kind of motion, a linear classifier of the kinds whose shares blend the maps, and the coupling: half
of each pose is the nearest one of the example clips, the clip at hand before others. Kinds are
found among the example clips by k-means, where theirs were named by users.

Input: example clips, and the ticks. Limits: kinematic; what it does well is what its clips show.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.cluster.vq import kmeans2

from studio import geometry
from studio.human.features import FEATURE_DIM
from studio.reference.intent import StateName
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.moving import Moving, columns_of, pose_rows, trunk_of
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.retarget.network import clipped_z, z_scores
from studio.robot import a1, kinematics

Array = NDArray[np.float64]

HUMAN: dict[str, tuple[str, ...]] = {
    "trunk": ("chest", "head", "shoulder", "height"),
    "right_arm": ("r_elbow", "r_wrist"),
    "left_arm": ("l_elbow", "l_wrist"),
    "legs": ("knee", "ankle"),
}
"""A person's features: joints by how their names end."""
ROBOT: dict[str, slice] = {
    "trunk": slice(0, 3),
    "front_right": slice(3, 6),
    "front_left": slice(6, 9),
    "rear": slice(9, 15),
}
"""The robot's: the trunk's turn, and where its feet are from it, m in the state's frame."""
FEATURE_PAIRS: dict[str, tuple[str, ...]] = {
    "trunk": ("trunk", "legs"),
    "front_right": ("right_arm", "trunk", "legs"),
    "front_left": ("left_arm", "trunk", "legs"),
    "rear": ("trunk", "legs"),
}
"""What of the robot follows what of the person."""
KINDS = 4
"""Kinds of motion in a state, each with maps of its own."""
EXAMPLES = 1500
"""Poses of the example clips that the motion is coupled to."""
COUPLED = 0.5
"""Share of a pose that is the examples'."""
GOES_ON = 0.5
"""An example that goes on with the clip at hand counts as this much nearer (a factor)."""
STEADY = 0.15
"""Share by which the kinds' shares follow the classifier in a control period."""
PENALTY = 1e-2
"""Of the ridge, per frame."""


@dataclass(frozen=True, kw_only=True)
class Maps:
    """inputs: columns of the triplet of each pair. weights: (KINDS, inputs + 1, outputs) of each.
    classify (2F + 1, KINDS); examples (M, 15) features, clip (M,)."""

    inputs: dict[str, NDArray[np.intp]]
    weights: dict[str, Array]
    classify: Array
    examples: Array
    clip: NDArray[np.int64]
    spread: Array


class Seol2013(FrameByFrame):
    """A state's expert."""

    def __init__(self, state: StateName, maps: Maps, mean: Array, scale: Array) -> None:
        self.state: StateName = state
        self.maps, self.mean, self.scale = maps, mean, scale

    @classmethod
    def fit(cls, state: StateName, pairs: Pairs, seed: int = 0) -> "Seol2013":
        """Of example clips."""
        mean, scale = z_scores(pairs.triplet)
        z = clipped_z(np.asarray(pairs.triplet, np.float64), mean, scale)
        robot = features(state, pose_rows(state, pairs))
        kind = _kinds(robot, pairs.clip, seed)
        inputs, weights = {}, {}
        for name, human in FEATURE_PAIRS.items():
            # Where a feature is and how fast it moves.
            q = np.concatenate([columns_of(*HUMAN[part]) for part in human])
            inputs[name] = np.concatenate([q, q + FEATURE_DIM])
            x, y = _with_one(z[:, inputs[name]]), robot[:, ROBOT[name]]
            whole = _ridge(x, y, np.ones(len(x)))
            # A kind's map departs from that of all where its own clips say so.
            each = [whole + _ridge(x, y - x @ whole, kind[:, k]) for k in range(kind.shape[1])]
            weights[name] = np.stack(each)
        kept = np.linspace(0, len(robot) - 1, min(EXAMPLES, len(robot))).round().astype(int)
        maps = Maps(
            inputs=inputs,
            weights=weights,
            classify=_ridge(_with_one(z[:, : 2 * FEATURE_DIM]), kind, np.ones(len(z))),
            examples=robot[kept],
            clip=np.asarray(pairs.clip[kept], np.int64),
            spread=np.maximum(robot.std(axis=0), 0.01),
        )
        return cls(state, maps, mean, scale)

    def begin(self) -> Callable[[NDArray], Mapped]:
        """Start anew: no kind is likelier, no clip at hand."""
        moving, maps = Moving(self.state), self.maps
        shares, clip = np.full(maps.classify.shape[1], 1.0 / maps.classify.shape[1]), -1

        def step(triplet: NDArray) -> Mapped:
            nonlocal shares, clip
            z = clipped_z(np.asarray(triplet, np.float64), self.mean, self.scale)
            voted = np.maximum(np.append(z[: 2 * FEATURE_DIM], 1.0) @ maps.classify, 1e-6)
            shares = shares + STEADY * (voted / voted.sum() - shares)
            row = np.empty(15)
            for name, part in ROBOT.items():
                x = np.append(z[maps.inputs[name]], 1.0)
                row[part] = shares @ (x @ maps.weights[name])
            far = np.sum(((maps.examples - row) / maps.spread) ** 2, axis=1)
            nearest = int(np.argmin(np.where(maps.clip == clip, GOES_ON * far, far)))
            clip = int(maps.clip[nearest])
            return moving.step(self._pose(row + COUPLED * (maps.examples[nearest] - row)))

        return step

    def _pose(self, row: Array) -> Array:
        """(15,) the pose with these features (15,), as far as the legs reach."""
        quat = trunk_of(self.state, row[:3])
        feet = geometry.quat_rotate_inverse(quat, row[3:].reshape(4, 3))
        return np.append(kinematics.leg_ik(feet)[0], row[:3])


def features(state: StateName, poses: Array) -> Array:
    """(N, 15) as ROBOT lays out, of poses (N, 15)."""
    quat = trunk_of(state, poses[:, 12:])
    feet = kinematics.foot_pos_w(np.zeros(3), quat, poses[:, : a1.NUM_JOINTS])
    return np.concatenate([poses[:, 12:], feet.reshape(-1, 12)], axis=1)


def _kinds(robot: Array, clip: NDArray, seed: int) -> Array:
    """(N, KINDS) one-hot: clips that move the same features as much are of a kind."""
    names = np.unique(clip)
    moved = np.stack([np.log(robot[clip == c].std(axis=0) + 0.005) for c in names])
    count = min(KINDS, len(names))
    of_clip = kmeans2(moved, count, minit="++", rng=np.random.default_rng(seed))[1]
    return np.eye(count)[of_clip[np.searchsorted(names, clip)]]


def _with_one(x: Array) -> Array:
    return np.concatenate([x, np.ones((len(x), 1))], axis=1)


def _ridge(x: Array, y: Array, weight: Array) -> Array:
    """(inputs, outputs), frames weighted (N,), the constant (last) not held to zero."""
    penalty = PENALTY * len(x) * np.diag([*([1.0] * (x.shape[1] - 1)), 1e-6])
    weighted = x * weight[:, None]
    gram = weighted.T @ x + penalty + 1e-9 * np.eye(len(penalty))
    return np.linalg.solve(gram, weighted.T @ y).astype(float)
