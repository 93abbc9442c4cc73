"""Ridge regression: the best linear map from triplets to robot frames."""

import numpy as np
from numpy.typing import NDArray

from studio.retarget.baselines.base import Targets, unstack, z_scores
from studio.retarget.mapper import Mapped

Array = NDArray[np.float64]


class Ridge:
    """W = (Z^T Z + penalty N I)^-1 Z^T Y over z-scored triplets Z with a constant column."""

    def __init__(self, triplet: NDArray, targets: Targets, penalty: float = 1e-3) -> None:
        self._mean, self._scale = z_scores(triplet)
        z = self._inputs(triplet)
        gram = z.T @ z + penalty * len(z) * np.diag([*([1.0] * (z.shape[1] - 1)), 0.0])
        self._weight = np.linalg.solve(gram, z.T @ targets.stacked())

    def __call__(self, triplet: NDArray) -> Mapped:
        """The linear estimate for each triplet (N, 3F)."""
        return unstack(self._inputs(triplet) @ self._weight)

    def _inputs(self, triplet: NDArray) -> Array:
        z = np.clip((np.asarray(triplet, np.float64) - self._mean) / self._scale, -5.0, 5.0)
        return np.concatenate([z, np.ones((len(z), 1))], axis=1)
