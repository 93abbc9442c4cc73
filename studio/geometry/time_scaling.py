"""Ways from 0 to 1, smooth at both ends: time scalings (Lynch & Park 2017, chapter 9.2)."""

from typing import overload

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@overload
def smoothstep(s: float) -> float: ...
@overload
def smoothstep(s: ArrayLike) -> Array: ...
def smoothstep(s: ArrayLike) -> Array | float:
    """3 s^2 - 2 s^3 of s (...) clipped to [0, 1]: at rest at both ends."""
    s = _clipped(s)
    return s * s * (3.0 - 2.0 * s)


@overload
def minimum_jerk(s: float) -> float: ...
@overload
def minimum_jerk(s: ArrayLike) -> Array: ...
def minimum_jerk(s: ArrayLike) -> Array | float:
    """10 s^3 - 15 s^4 + 6 s^5 of s (...) clipped to [0, 1]: at rest and unaccelerated at both
    ends."""
    s = _clipped(s)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


def _clipped(s: ArrayLike) -> Array | float:
    """One number as a float: the control loop's innermost steps are ten times quicker for it."""
    if isinstance(s, float):
        return min(max(s, 0.0), 1.0)
    return np.minimum(np.maximum(np.asarray(s, dtype=np.float64), 0.0), 1.0)
