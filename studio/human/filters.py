"""Causal smoothing: tracked points in, steadier points out, missing ones held and then eased."""

import math

import numpy as np
from numpy.typing import NDArray

from studio.timing import CONTROL_DT

Array = NDArray[np.float64]


def smoothing(cutoff: Array | float, dt: float) -> Array | float:
    """Gain (...) r / (r + 1), r = 2π f dt, of a first-order low-pass at f = `cutoff` (...) Hz."""
    r = (2.0 * math.pi * dt) * cutoff
    return r / (r + 1.0)


class OneEuro:
    """The 1€ filter (Casiez, Roussel, Vogel, CHI 2012): quicker hands are smoothed less.

    Over points (..., 3): the cutoff of each is min_cutoff + beta · |speed|, Hz with the speed in
    m/s, itself low-passed at d_cutoff. One speed per point, not per axis, so that the result
    turns with the world. Defaults as measured on webcam tracking at 30 Hz. One thread.
    """

    def __init__(
        self,
        min_cutoff: float = 1.5,
        beta: float = 0.5,
        d_cutoff: float = 1.0,
        dt: float = CONTROL_DT,
    ) -> None:
        self._min_cutoff, self._beta, self._dt = min_cutoff, beta, dt
        self._d_gain = float(smoothing(d_cutoff, dt))
        self.reset()

    def reset(self) -> None:
        """Take the next sample as it is."""
        self._raw: Array | None = None

    def push(self, x: Array) -> Array:
        """The filtered value of the next sample (..., 3); the first comes back unchanged."""
        if self._raw is None:
            self._raw = self._value = np.array(x, dtype=np.float64)
            self._speed = np.zeros_like(self._value)
            return self._value
        self._speed = self._speed + self._d_gain * ((x - self._raw) / self._dt - self._speed)
        self._raw = x
        speed = np.sqrt(np.einsum("...i,...i->...", self._speed, self._speed))
        gain = np.asarray(smoothing(self._min_cutoff + self._beta * speed, self._dt))[..., None]
        self._value = self._value + gain * (x - self._value)
        return self._value


class HoldThenEase:
    """Directions that go missing: held for `hold` s, then eased (time constant `tau` s) to neutral.

    For unit vectors (B, 3), all in one frame, each with an age of its own. One thread.
    """

    def __init__(
        self, neutral: Array, hold: float = 0.5, tau: float = 0.5, dt: float = CONTROL_DT
    ) -> None:
        self._neutral, self._hold, self._dt = neutral, hold, dt
        self._gain = 1.0 - math.exp(-dt / tau)
        self.reset()

    def reset(self) -> None:
        """Back to neutral, nothing seen."""
        self._value = self._neutral.copy()
        self._age = np.full(len(self._neutral), self._hold + self._dt)

    @property
    def age(self) -> Array:
        """(B,) s since each was seen."""
        return self._age

    def push(self, direction: Array, seen: NDArray[np.bool_]) -> Array:
        """The directions (B, 3) to use: `direction` where seen (B,), else held or eased."""
        if seen.all():
            self._age[:] = 0.0
            self._value = direction
            return direction
        self._age = np.where(seen, 0.0, self._age + self._dt)
        value = np.where(seen[:, None], direction, self._value)
        easing = self._age > self._hold + 1e-9
        if easing.any():
            eased = value[easing] + self._gain * (self._neutral[easing] - value[easing])
            length = np.sqrt(np.einsum("bi,bi->b", eased, eased))[:, None]
            # Opposite to neutral the straight way passes through zero: go there at once.
            value[easing] = np.where(
                length > 1e-3, eased / np.maximum(length, 1e-3), self._neutral[easing]
            )
        self._value = value
        return value
