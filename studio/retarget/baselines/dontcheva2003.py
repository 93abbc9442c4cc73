"""Dontcheva, Yngve, Popović 2003: a person mimics clips; a map is inferred, body part after part.

Source: M. Dontcheva, G. Yngve, Z. Popović, "Layered Acting for Character Animation", SIGGRAPH 2003:
an actor acts along with an existing motion, and again to add a layer to it; how the actor's motion
corresponds to the character's is inferred from the mimicry.

Kept: clips that were mimicked (MIMICKED performances), aligned by dynamic time warping where their
canonical variates (CCA) agree, alignment and CCA in turns; least squares from the variates to the
robot's joints; and the layers: the trunk first, then a leg after another, each from the part of
the body that correlates with it best and from the layers before it. Not kept: repeating the act
until it pleases; theirs works on whole takes, here the inferred map is applied frame by frame.

Input: a few mimicked clips. Limits: linear in the pose and its velocity; kinematic; its fit wants
both clips whole, so a new mapping means acting and waiting.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.features import FEATURE_DIM
from studio.reference.intent import StateName
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.moving import Moving, columns_of, pose_rows
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.retarget.network import clipped_z, z_scores

Array = NDArray[np.float64]

MIMICKED = 12
"""Clips, some seconds each."""
ROUNDS = 2
"""Of alignment and CCA in turns."""
BAND = 12
"""Control periods (0.4 s) by which a mimic may be late or early."""
VARIATES = 6
"""Canonical variates a layer is told from, at most."""
INPUTS = 20
"""Principal components of a body part that CCA sees."""
PENALTY = 1e-3
"""Of the least squares, per frame."""
LAYERS: dict[str, slice] = {
    "trunk": slice(12, 15),
    "rear_legs": slice(6, 12),
    "front_right": slice(0, 3),
    "front_left": slice(3, 6),
}
"""Of a pose (15,), in the order in which they are acted."""
BODY: dict[str, tuple[str, ...]] = {
    "trunk": ("spine", "chest", "neck", "head", "shoulder", "height"),
    "right_arm": ("r_elbow", "r_wrist"),
    "left_arm": ("l_elbow", "l_wrist"),
    "legs": ("hip", "knee", "ankle", "toe"),
    "all": ("spine", "head", "shoulder", "elbow", "wrist", "knee", "ankle", "height"),
}
"""Parts of a person's body: joints by how their names end."""


@dataclass(frozen=True, kw_only=True)
class Layer:
    """part: of BODY that it is acted with. inputs: columns of the triplet. project (inputs, C) to
    canonical variates; weights (C + poses before + 1, outputs); correlation: the mean canonical."""

    part: str
    inputs: NDArray[np.intp]
    project: Array
    weights: Array
    correlation: float


class Dontcheva2003(FrameByFrame):
    """A state's expert."""

    def __init__(
        self, state: StateName, layers: dict[str, Layer], mean: Array, scale: Array
    ) -> None:
        self.state: StateName = state
        self.layers, self.mean, self.scale = layers, mean, scale

    @classmethod
    def fit(cls, state: StateName, pairs: Pairs, seed: int = 0) -> "Dontcheva2003":
        """Of MIMICKED performances, drawn from the seed, or all where there are fewer."""
        clips = np.unique(pairs.clip)
        few = min(MIMICKED, len(clips))
        chosen = np.random.default_rng(seed).choice(clips, few, replace=False)
        mean, scale = z_scores(pairs.triplet)
        human = [
            clipped_z(np.asarray(pairs.triplet[pairs.clip == c], np.float64), mean, scale)
            for c in chosen
        ]
        poses = pose_rows(state, pairs)
        robot = [poses[pairs.clip == c] for c in chosen]
        layers: dict[str, Layer] = {}
        done: list[slice] = []
        for name, part in LAYERS.items():
            layers[name] = _layer(human, robot, part, done)
            done.append(part)
        return cls(state, layers, mean, scale)

    def begin(self) -> "_Acting":
        """Start anew."""
        return _Acting(self)


class _Acting:
    """One person's act in progress. One thread."""

    remembers = True

    def __init__(self, map_: Dontcheva2003) -> None:
        self._map, self._moving = map_, Moving(map_.state)

    def __call__(self, triplet: NDArray) -> Mapped:
        """One control period's triplet (3F,) to what an expert says of it."""
        z = clipped_z(np.asarray(triplet, np.float64), self._map.mean, self._map.scale)
        pose = np.zeros(15)
        before: list[Array] = []
        for name, part in LAYERS.items():
            layer = self._map.layers[name]
            x = np.concatenate([z[layer.inputs] @ layer.project, *before, [1.0]])
            pose[part] = x @ layer.weights
            before.append(pose[part])
        return self._moving.step(pose)


def _layer(human: list[Array], robot: list[Array], part: slice, done: list[slice]) -> Layer:
    """The layer `part`, from the part of the body that goes with it best."""
    found = [(*_aligned(human, robot, part, name), name) for name in BODY]
    project, at, correlation, name = max(found, key=lambda each: each[2])
    inputs = _inputs(name)
    x = np.concatenate([h[i][:, inputs] @ project for h, i in zip(human, at, strict=True)])
    y = np.concatenate(robot)
    terms = np.concatenate([x, *(y[:, d] for d in done), np.ones((len(x), 1))], axis=1)
    penalty = PENALTY * len(terms) * np.eye(terms.shape[1])
    penalty[-1, -1] = 1e-9
    weights: Array = np.linalg.solve(terms.T @ terms + penalty, terms.T @ y[:, part]).astype(float)
    return Layer(
        part=name, inputs=inputs, project=project, weights=weights, correlation=correlation
    )


def _inputs(name: str) -> NDArray[np.intp]:
    q = columns_of(*BODY[name])
    return np.concatenate([q, q + FEATURE_DIM])


def _aligned(
    human: list[Array], robot: list[Array], part: slice, name: str
) -> tuple[Array, list[NDArray[np.intp]], float]:
    """Projection to canonical variates, the person's frame for each of the robot's, clip by clip,
    and the mean canonical correlation."""
    inputs = _inputs(name)
    at: list[NDArray[np.intp]] = [np.arange(len(r)) for r in robot]
    target = np.concatenate([r[:, part] for r in robot])
    for turn in range(ROUNDS + 1):
        x = np.concatenate([h[i][:, inputs] for h, i in zip(human, at, strict=True)])
        project, to, correlation = cca(x, target)
        if turn < ROUNDS:
            at = [
                warp(h[:, inputs] @ project, (r[:, part] - target.mean(axis=0)) @ to)
                for h, r in zip(human, robot, strict=True)
            ]
    # A part that never moves goes with nothing.
    return project, at, float(correlation.mean()) if len(correlation) else 0.0


def cca(x: Array, y: Array) -> tuple[Array, Array, Array]:
    """Projections (D, C) of x (N, D) and (E, C) of y (N, E) whose columns correlate most, and the
    correlations (C,)."""
    whiten_x, whiten_y = _whitened(x, INPUTS), _whitened(y, y.shape[1])
    a, b = (x - x.mean(axis=0)) @ whiten_x, (y - y.mean(axis=0)) @ whiten_y
    u, s, vt = np.linalg.svd(a.T @ b / len(x), full_matrices=False)
    count = min(VARIATES, len(s))
    return whiten_x @ u[:, :count], whiten_y @ vt[:count].T, np.minimum(s[:count], 1.0)


def _whitened(x: Array, most: int) -> Array:
    """(D, C): what makes the C first principal components of x (N, D), of unit variance."""
    values, vectors = np.linalg.eigh(np.cov(x, rowvar=False))
    keep = np.argsort(values)[::-1][:most]
    keep = keep[values[keep] > 1e-6 * max(values.max(), 1e-12)]
    return vectors[:, keep] / np.sqrt(values[keep] + 1e-6)


def warp(x: Array, y: Array) -> NDArray[np.intp]:
    """Dynamic time warping: the frame of x (T, C) for each of y (T, C), BAND periods off at most.

    Monotone; a frame of x may be passed over or stand for several of y.
    """
    offsets = np.arange(-BAND, BAND + 1)
    frames, width = len(y), len(offsets)
    cost, came = np.full(width, np.inf), np.zeros((frames, width), dtype=np.intp)
    for t in range(frames):
        at = t + offsets
        there = (at >= 0) & (at < frames)
        apart = np.full(width, np.inf)
        apart[there] = np.sum((x[at[there]] - y[t]) ** 2, axis=1)
        if t == 0:
            cost = apart
            continue
        # From the frame before (offset + 1), the one at the same offset, or one passed over.
        ways = np.full((3, width), np.inf)
        ways[0, :-1], ways[1], ways[2, 1:] = cost[1:], cost, cost[:-1]
        best = np.argmin(ways, axis=0)
        came[t] = np.arange(width) + 1 - best
        cost = apart + ways[best, np.arange(width)]
    k = int(np.argmin(cost))
    out = np.empty(frames, dtype=np.intp)
    for t in range(frames - 1, -1, -1):
        out[t] = t + offsets[k]
        k = int(came[t, k])
    return out
