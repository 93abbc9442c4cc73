"""Streaming filters whose output does not depend on how time is cut into blocks."""

import numpy as np
from numpy.typing import NDArray
from scipy.signal import lfilter

from studio.synthetic.signals import DT

Array = NDArray[np.float64]


def movement_kernel(seconds: float, dt: float, shape: str) -> Array:
    """A kernel of unit sum: a step convolved with it becomes a movement of that duration.

    shape "minimum_jerk": speed 30 s^2 (1 - s)^2 (Flash and Hogan 1985), as people reach;
    "trapezoid": speeds up, holds, slows down; "hasty": a fast start and a slow arrival.
    """
    n = max(round(seconds / dt), 1)
    s = (np.arange(n) + 0.5) / n
    if shape == "minimum_jerk":
        k = s**2 * (1.0 - s) ** 2
    elif shape == "trapezoid":
        k = np.minimum(np.minimum(s, 1.0 - s) / 0.3, 1.0)
    else:
        k = s * (1.0 - s) ** 3
    return k / k.sum()


class Fir:
    """y = kernel * x along time, settled on the first row it sees (as if held for ever)."""

    def __init__(self, kernel: Array) -> None:
        self._b = kernel
        self._zi: Array | None = None

    def __call__(self, x: Array) -> Array:
        if len(self._b) == 1:
            return self._b[0] * x
        if self._zi is None:
            # State of a direct form II transposed FIR after a constant input x0.
            tail = np.cumsum(self._b[::-1])[::-1][1:]
            column = (-1, *([1] * (x.ndim - 1)))
            self._zi, self._taps = tail.reshape(column) * x[:1], self._b[1:].reshape(column)
        if len(x) == 1:  # live: the same recurrence, without lfilter's hundred microseconds
            z = self._zi
            y = z[:1] + self._b[0] * x
            z[:-1] = z[1:] + self._taps[:-1] * x
            z[-1:] = self._taps[-1] * x
            return y
        y, self._zi = lfilter(self._b, 1.0, x, axis=0, zi=self._zi)
        return y


class MeanCadence:
    """Cadence of a march as a whole: the mean over recent strides, pauses not counted.

    E[c^2] / E[c] over a second, drawn to `usual` while nobody marches. A cadence read off at once
    would change within a step that begins or ends, and the foot with it.
    """

    def __init__(self, usual: float = 0.8, seconds: float = 1.0) -> None:
        self._a = float(np.exp(-DT / seconds))
        self._zi = np.zeros((1, 2))
        self._pull, self._usual = 0.05, usual

    def __call__(self, cadence: Array) -> Array:
        """(T,) of the next cadences (T,), strides per second."""
        x = np.stack([cadence, cadence**2], axis=-1)
        y, self._zi = lfilter([1.0 - self._a], [1.0, -self._a], x, axis=0, zi=self._zi)
        return (y[:, 1] + self._pull * self._usual) / (y[:, 0] + self._pull)


class BandLimitedNoise:
    """Band-limited noise of unit standard deviation: white noise twice through a low pass.

    tau: s, the correlation time of each pass. Starts in its stationary spread.
    """

    def __init__(self, rng: np.random.Generator, shape: tuple[int, ...], tau: float, dt: float):
        self._rng, self._shape = rng, shape
        a = float(np.exp(-dt / tau))
        b = 1.0 - a
        self._filter = ((b * b,), (1.0, -2.0 * a, a * a))
        # Stationary variance of the AR(2) with a double pole a, driven by b^2 white noise.
        self._gain = 1.0 / np.sqrt(b**4 * (1.0 + a**2) / (1.0 - a**2) ** 3)
        self._zi = np.zeros((2, *shape))
        self(round(6 * tau / dt))

    def __call__(self, steps: int) -> Array:
        """(steps, *shape), the next rows of the process."""
        white = self._rng.standard_normal((steps, *self._shape))
        if steps == 1:
            (b,), (_, a1, a2) = self._filter
            z = self._zi
            y = z[:1] + b * white
            z[0], z[1] = z[1] - a1 * y[0], -a2 * y[0]
            return self._gain * y
        y, self._zi = lfilter(*self._filter, white, axis=0, zi=self._zi)
        return self._gain * y
