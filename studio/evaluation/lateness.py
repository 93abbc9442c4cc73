"""How much later one signal does what another does: lag of the whole, and of its beginning."""

import numpy as np
from numpy.typing import NDArray

from studio.robot.a1 import CONTROL_DT

Array = NDArray[np.float64]

LONGEST_S = 1.0
"""The largest lag that is looked for."""
ALIKE = 0.5
"""Least correlation with the person at which a stage counts as having followed at all."""
STARTS_S = 3.0
"""The latest beginning of a movement that is looked for."""
SETS_OUT = 0.15
"""Share of its range by which a signal leaves its rest when a movement begins."""


def lag_s(person: Array, stage: Array, dt: float = CONTROL_DT) -> float | None:
    """s by which one (T,) trails another: at the peak of their normalised cross-correlation,
    between the periods by a parabola; None where they are nowhere alike."""
    last = min(round(LONGEST_S / dt), len(person) // 3)
    if last < 2 or np.ptp(person) == 0.0 or np.ptp(stage) == 0.0:
        return None
    pairs = [(person[: len(person) - k], stage[k:]) for k in range(last + 1)]
    alike = np.array([np.corrcoef(*pair)[0, 1] if np.ptp(pair[1]) else 0.0 for pair in pairs])
    k = int(np.argmax(alike))
    if not alike[k] >= ALIKE:
        return None
    if not 0 < k < last:
        return float(dt * k)
    before, peak, after = alike[k - 1 : k + 2]
    return float(dt * (k + 0.5 * (before - after) / (before - 2.0 * peak + after)))


def onset_s(signal: Array, begin: float, dt: float = CONTROL_DT) -> float | None:
    """s at which (T,) leaves the rest that it was in at `begin` s, between the periods by a
    straight line; None where it does not within STARTS_S."""
    first = round(begin / dt)
    rest = float(np.median(signal[max(first - 15, 0) : first + 1]))
    part = signal[first : first + round(STARTS_S / dt)]
    left = np.abs(part - rest) / max(float(np.ptp(signal)), 1e-9)
    beyond = np.flatnonzero(left > SETS_OUT)
    if not len(beyond) or beyond[0] == 0:
        return None
    i = int(beyond[0])
    return float(dt * (first + i - 1 + (SETS_OUT - left[i - 1]) / (left[i] - left[i - 1])))
