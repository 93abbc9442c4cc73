"""Yamane, Ariki, Hodgins 2010: a Gaussian-process latent space shared by a few key-pose pairs.

Source: K. Yamane, Y. Ariki, J. Hodgins, "Animating Non-Humanoid Characters with Human Motion
Data", SCA 2010: an actor strikes 30 to 50 key poses of a character; a shared GPLVM maps poses.

Kept: the key poses (here those furthest from one another in the robot's poses), one latent point a
pair with a Gaussian process to the person's pose and one to the robot's, fitted together; live, the
latent begins at a back-constraint (a kernel map from the person's pose) and takes a few Gauss-
Newton steps to explain it; the robot's pose is the mean there. Contact IK comes after, as for
everybody here. Not kept: their optimisation of whole motions by physics, which is not live.

Input: poses without velocities. Limits: what differs by its direction in time is one pose to it (a
foot on its way up or down), so marches lift feet and go a quarter of the way.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import cho_factor, cho_solve
from scipy.optimize import minimize

from studio.human.features import FEATURE_DIM
from studio.reference.intent import StateName
from studio.retarget.baselines.frames import Pairs
from studio.retarget.baselines.moving import Moving, pose_rows
from studio.retarget.mapper import FrameByFrame, Mapped
from studio.retarget.network import clipped_z, z_scores

Array = NDArray[np.float64]

KEY_POSES = 40
"""Theirs were 30 to 50."""
LATENT = 6
"""Dimensions of the shared space."""
STEPS = 3
"""Gauss-Newton steps a control period."""
FITTED = 150
"""Steps of the optimiser of latents and kernels."""
CARRIED = 0.5
"""Share of the last latent in where the next one begins: their motions are smooth, too."""


@dataclass(frozen=True, kw_only=True)
class SharedLatent:
    """points (K, Q); weights of both means, (K, D) of the person's z-scores, (K, 15) of the robot's
    poses less their mean; back (K, Q) from kernels of the person's poses `human` (K, D)."""

    points: Array
    to_human: Array
    to_robot: Array
    robot_mean: Array
    robot_scale: Array
    human: Array
    back: Array
    width: float

    def start(self, z: Array) -> Array:
        """(Q,) by the back-constraint, of a person's z-scores (D,)."""
        return _kernel(z[None], self.human, self.width)[0] @ self.back

    def explain(self, x: Array, z: Array) -> Array:
        """(Q,) a few steps on from x (Q,), where the person's mean is nearer to z (D,)."""
        for _ in range(STEPS):
            apart = x - self.points
            k = np.exp(-0.5 * np.sum(apart**2, axis=1))
            jacobian = -(self.to_human.T * k) @ apart
            error = z - k @ self.to_human
            # The latents' own spread is 1: that is their prior.
            normal = jacobian.T @ jacobian + np.eye(len(x))
            x = x + np.linalg.solve(normal, jacobian.T @ error - x)
        return x

    def pose(self, x: Array) -> Array:
        """(15,) the robot's pose at x (Q,)."""
        mean = _kernel(x[None], self.points, 1.0)[0] @ self.to_robot
        return self.robot_mean + self.robot_scale * mean


class Yamane2010(FrameByFrame):
    """A state's expert."""

    def __init__(self, state: StateName, latent: SharedLatent, mean: Array, scale: Array) -> None:
        self.state: StateName = state
        self.latent, self.mean, self.scale = latent, mean, scale

    @classmethod
    def fit(
        cls, state: StateName, pairs: Pairs, seed: int = 0, key_poses: int = KEY_POSES
    ) -> "Yamane2010":
        """Of KEY_POSES of the pairs, or all where there are fewer."""
        mean, scale = (part[:FEATURE_DIM] for part in z_scores(pairs.triplet))
        robot = pose_rows(state, pairs)
        keys = key_frames(robot, min(key_poses, len(robot)), seed)
        human = clipped_z(np.asarray(pairs.triplet[keys, :FEATURE_DIM], np.float64), mean, scale)
        return cls(state, shared_latent(human, robot[keys]), mean, scale)

    def begin(self) -> Callable[[NDArray], Mapped]:
        """Start anew from the first pose's back-constraint."""
        moving, latent = Moving(self.state), self.latent
        x: Array | None = None

        def step(triplet: NDArray) -> Mapped:
            nonlocal x
            q = np.asarray(triplet[:FEATURE_DIM], np.float64)
            z = clipped_z(q, self.mean, self.scale)
            begin = latent.start(z)
            x = latent.explain(begin if x is None else begin + CARRIED * (x - begin), z)
            return moving.step(latent.pose(x))

        return step


def key_frames(robot: Array, count: int, seed: int) -> NDArray[np.intp]:
    """Indices (count,) of poses (N, 15), each as far as can be from those before it."""
    first = int(np.random.default_rng(seed).integers(len(robot)))
    chosen, far = [first], np.full(len(robot), np.inf)
    while len(chosen) < count:
        far = np.minimum(far, np.sum((robot - robot[chosen[-1]]) ** 2, axis=1))
        chosen.append(int(np.argmax(far)))
    return np.array(chosen)


def shared_latent(human: Array, robot: Array) -> SharedLatent:
    """Fit latents and both kernels to key poses (K, D) and (K, 15) by their joint likelihood."""
    robot_mean, robot_scale = robot.mean(axis=0), np.maximum(robot.std(axis=0), 0.02)
    outputs = [human, (robot - robot_mean) / robot_scale]
    # Each side counts as much, however many numbers it has.
    grams = [y @ y.T / y.shape[1] for y in outputs]
    size = min(LATENT, len(human) - 1)
    both = np.concatenate([y / np.sqrt(y.shape[1]) for y in outputs], axis=1)
    u, _, _ = np.linalg.svd(both - both.mean(axis=0), full_matrices=False)
    begin = u[:, :size] * np.sqrt(len(human))
    packed = np.concatenate([begin.ravel(), np.log([1.0, 0.1, 1.0, 0.1])])
    found = minimize(
        _cost, packed, (grams, begin.shape), jac=True, method="L-BFGS-B",
        bounds=[(None, None)] * begin.size + [(-3.0, 4.0), (-5.0, 1.0)] * 2,
        options={"maxiter": FITTED},
    ).x  # fmt: skip
    points = found[: begin.size].reshape(begin.shape)
    kernel = _kernel(points, points, 1.0)
    weights = []
    for y, (size_, noise) in zip(outputs, np.exp(found[begin.size :]).reshape(2, 2), strict=True):
        factor = cho_factor(size_ * kernel + noise * np.eye(len(points)))
        weights.append(size_ * cho_solve(factor, y))
    apart = np.sqrt(np.sum((human[:, None] - human[None]) ** 2, axis=-1))
    width = max(float(np.median(apart[apart > 0.0])), 1e-6) if np.any(apart > 0.0) else 1.0
    gram = _kernel(human, human, width)
    return SharedLatent(
        points=points,
        to_human=weights[0],
        to_robot=weights[1],
        robot_mean=robot_mean,
        robot_scale=robot_scale,
        human=human,
        back=np.linalg.solve(gram + 0.02 * np.eye(len(gram)), points),
        width=width,
    )


def _kernel(a: Array, b: Array, width: float) -> Array:
    square = np.sum((a[:, None] - b[None]) ** 2, axis=-1)
    return np.exp(-0.5 * square / width**2)


def _cost(packed: Array, grams: list[Array], shape: tuple[int, int]) -> tuple[float, Array]:
    """−log p(both sides, latents), each side per number it has, and its gradient."""
    points = packed[: shape[0] * shape[1]].reshape(shape)
    logs = packed[shape[0] * shape[1] :]
    kernel, eye = _kernel(points, points, 1.0), np.eye(len(points))
    value = 0.5 * float(np.sum(points**2)) / shape[1]
    slope, slopes = points / shape[1], np.zeros(4)
    for m, gram in enumerate(grams):
        size, noise = np.exp(logs[2 * m : 2 * m + 2]).tolist()
        covariance = size * kernel + noise * eye
        factor = cho_factor(covariance)
        inverse = cho_solve(factor, eye)
        value += float(np.sum(np.log(np.diag(factor[0])))) + 0.5 * float(np.sum(inverse * gram))
        by_kernel = 0.5 * (inverse - inverse @ gram @ inverse)
        pull = by_kernel * size * kernel
        slope = slope + 2.0 * (pull @ points - pull.sum(axis=1, keepdims=True) * points)
        slopes[2 * m] = np.sum(pull)
        slopes[2 * m + 1] = noise * np.trace(by_kernel)
    return value, np.concatenate([slope.ravel(), slopes])
