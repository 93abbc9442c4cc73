"""Person and robot to how likely every lag is: two views of the same motion, weighed together.

Places: a linear model of the person's band-passed body on the robot's pose at every lag,

    log L(k) = -n/2 sum_i log(1 - rho_i(k)^2),   n: independent samples

rho_i: the largest canonical correlations of H(t + k) and R(t). Noise common to many joints (sway, a
sensor that wanders) counts once. Speeds: what the same model leaves of all joints' speeds,

    log L(k) = -T/2 log det(E(k)' E(k) + noise)

where slow sway hardly counts. Neither assumes a gain of the person's. They err differently: on 240
takes places alone are within a frame in 73 %, speeds in 78 %, both in 82 %.
"""

from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from scipy.signal import butter, sosfiltfilt

from studio.robot import a1

Array = NDArray[np.float64]

VERSION = 3
"""Of the curves that are kept beside takes."""
BAND_HZ = (0.25, 6.0)
"""Of places: what is slower than a movement is drift, what is faster is noise."""
DIMS, RANK = 16, 3
"""Principal components of the person's places, and how many directions among them are explained:
more would let noise vote."""
SAMPLES_HZ = 0.6
"""Independent samples in a second of motion, so few that `Alignment.certainty` claims no more than
it holds (tests/takes/test_takes_lag.py)."""
SPEED_HZ = 3.0
"""Of speeds: nothing faster was shown."""
NOISE_M = 0.01
"""Noise of every joint at least: what a sensor sees steadier than that is not told apart."""
SPEED_SAMPLES = 0.05
"""Independent samples in a frame, by speeds."""
SPEED_WEIGHT = 0.7
"""Share of the speeds' view in the sum."""


def levels(
    pose: Array, shown: Array, steps: list[Array], lags: Array
) -> tuple[Array, Array, Array]:
    """(K,) log likelihood of lags (frames), by both views and by places alone, and (K,) the share
    of places that is explained.

    pose (T, J) m. shown (T, P) of the robot, in spreads. steps: guesses (T, 2) at the steps of
    somebody who walks with it; the best of them counts; [] when nobody walks. Raises ValueError
    where nobody moves.
    """
    n = len(pose)
    body = _band(pose)
    body -= body.mean(axis=0)
    values, vectors = np.linalg.eigh(body.T @ body)
    if values[-1] < 1e-12:
        raise ValueError("nobody moves")
    parts = body @ vectors[:, -DIMS:]
    place, explained = np.full(len(lags), -np.inf), np.zeros(len(lags))
    guesses = [np.concatenate([shown, guess], axis=1) for guess in steps] or [shown]
    for guess in guesses:
        basis = _basis(_band(guess))
        for j, k in enumerate(lags):
            y = parts[np.clip(np.arange(n) + int(k), 0, n - 1)]
            y = y - y.mean(axis=0)
            rest = y - basis @ (basis.T @ y)
            likely = SAMPLES_HZ * a1.CONTROL_DT * n * _canonical(y, rest)
            if likely > place[j]:
                place[j], explained[j] = likely, 1.0 - np.sum(rest**2) / np.sum(y**2)
    speed = SPEED_SAMPLES * _by_speed(_speed(pose), guesses[len(guesses) // 2], lags)
    if steps:
        place, speed = _blurred(place), _blurred(speed)
    both = (1.0 - SPEED_WEIGHT) * place + SPEED_WEIGHT * (speed - speed.max())
    return both, place, explained


def _canonical(y: Array, rest: Array) -> float:
    """-1/2 the sum of log(1 - rho^2) over the RANK largest canonical correlations rho."""
    jitter = 1e-9 * len(y) * np.eye(y.shape[1])
    half = np.linalg.inv(np.linalg.cholesky(y.T @ y + jitter))
    left = np.linalg.eigvalsh(half @ (rest.T @ rest + jitter) @ half.T)[:RANK]
    return -0.5 * float(np.sum(np.log(np.maximum(left, 1e-6))))


def _by_speed(speed: Array, shown: Array, lags: Array) -> Array:
    """(K,) -T/2 log det of what is left of the person's speeds (T, J) at each lag."""
    n, far = len(speed), int(np.abs(lags).max())
    # The robot rests at both ends: there, its last pose is taken to last.
    moved = _speed(np.pad(shown, ((far, far), (0, 0)), mode="edge"))
    floor = n * _noise_gain() * NOISE_M**2 * np.eye(speed.shape[1])
    whole = speed - speed.mean(axis=0)
    square = whole.T @ whole + floor
    out = np.empty(len(lags))
    for j, k in enumerate(lags.astype(int)):
        along = _basis(moved[far - k : far - k + n]).T @ whole
        out[j] = -0.5 * n * np.linalg.slogdet(square - along.T @ along)[1]
    return out


def _blurred(level: Array) -> Array:
    """A likelihood that allows a frame of doubt: how long a person's foot stays up is a guess."""
    if len(level) < 3:
        return level
    away = np.arange(-4, 5)
    wide = np.pad(level, 4, mode="edge")
    windows = np.lib.stride_tricks.sliding_window_view(wide, 9) - 0.5 * away**2
    top = windows.max(axis=-1)
    return top + np.log(np.exp(windows - top[:, None]).sum(axis=-1))


def _basis(x: Array) -> Array:
    """Orthonormal columns (T, K) spanning x, without directions in which hardly anything is."""
    u, s, _ = np.linalg.svd(x - x.mean(axis=0), full_matrices=False)
    return u[:, s > 0.02 * max(s[0], 1e-9)]


@lru_cache(maxsize=4)
def _filter(kind: str, hz: float | tuple[float, float]) -> Array:
    return np.asarray(butter(2, hz, kind, fs=a1.CONTROL_HZ, output="sos"))


def _filtered(x: Array, kind: str, hz: float | tuple[float, float]) -> Array:
    padded = np.pad(x, ((45, 45), (0, 0)), mode="edge")
    return np.asarray(sosfiltfilt(_filter(kind, hz), padded, axis=0), dtype=np.float64)[45:-45]


def _band(x: Array) -> Array:
    return _filtered(x, "band", BAND_HZ)


def _speed(x: Array) -> Array:
    return np.gradient(_filtered(x, "low", SPEED_HZ), a1.CONTROL_DT, axis=0)


@lru_cache(maxsize=1)
def _noise_gain() -> float:
    """Variance that `_speed` makes of white noise of variance 1."""
    pulse = np.zeros((301, 1))
    pulse[150] = 1.0
    return float(np.sum(_speed(pulse) ** 2))
