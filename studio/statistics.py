"""What a set of values comes to: percentiles, and how sure a statistic of them is."""

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


def percentiles(values: ArrayLike) -> dict[str, float]:
    """The p50, p95 and p99 of values (N,), N over 0, in their unit."""
    return dict(
        zip(
            ("p50", "p95", "p99"),
            np.percentile(np.asarray(values, dtype=np.float64), [50, 95, 99]).tolist(),
        )
    )


def bootstrap_ci(
    values: ArrayLike,
    statistic: Callable[[Array], float] = lambda x: float(np.mean(x)),
    *,
    resamples: int = 1000,
    level: float = 0.95,
    seed: int = 0,
) -> tuple[float, float]:
    """Percentile bootstrap interval of a statistic of independent episodes' values (N,).

    Percentiles (1 +- level) / 2 of the statistic over `resamples` draws with replacement (Efron
    1979). NaN for no values.
    """
    values = np.asarray(values, dtype=np.float64)
    if not len(values):
        return float("nan"), float("nan")
    rng = np.random.default_rng(seed)
    draws = [statistic(values[rng.integers(0, len(values), len(values))]) for _ in range(resamples)]
    low, high = np.quantile(draws, [0.5 - 0.5 * level, 0.5 + 0.5 * level])
    return float(low), float(high)
