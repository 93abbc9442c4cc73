"""A controller's joint targets to targets the motors can follow: low-pass, then limits last.

The PD law itself and the torque limit are the model's actuators (`sim.spec`): torque =
clip(kp (target - q) - kd qd, +-33.5 N m), evaluated at every physics step.
"""

from typing import cast

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy import signal

from studio.robot import a1

Array = NDArray[np.float64]

CUTOFF_HZ = 5.0
"""The paper's action filter: Butterworth at 5 Hz, at 30 Hz; order 2 delays slow motion by 41 ms."""


class LowPass:
    """A causal second-order Butterworth low-pass over control periods; one thread at a time.

    `reset(value)` starts it at rest at `value` (..., n), so that a constant input comes out
    unchanged from the first step; `step(value)` filters one sample of the same shape.
    """

    def __init__(self, cutoff_hz: float = CUTOFF_HZ, rate_hz: float = a1.CONTROL_HZ) -> None:
        b, a = cast(tuple[Array, Array], signal.butter(2, cutoff_hz, fs=rate_hz))
        self._b, self._a = b.tolist(), a.tolist()
        self._state: tuple[Array, Array] | None = None

    def reset(self, value: ArrayLike, where: ArrayLike | None = None) -> None:
        """At rest at `value`; in a batch (N, n), only for the rows of the mask `where` (N,)."""
        x = np.asarray(value, dtype=np.float64)
        rest = (1.0 - self._b[0]) * x, (self._b[2] - self._a[2]) * x
        if where is None or self._state is None:
            self._state = rest
        else:
            mask = np.asarray(where)[..., None]
            old1, old2 = self._state
            self._state = np.where(mask, rest[0], old1), np.where(mask, rest[1], old2)

    def step(self, value: ArrayLike) -> Array:
        """The filtered sample. The first value given without a reset starts it at rest."""
        x = np.asarray(value, dtype=np.float64)
        if self._state is None:
            self.reset(x)
        assert self._state is not None
        (b0, b1, b2), (_, a_1, a_2) = self._b, self._a
        z1, z2 = self._state  # direct form II, transposed
        y = b0 * x + z1
        self._state = b1 * x - a_1 * y + z2, b2 * x - a_2 * y
        return y


class MotorTargets:
    """A controller's actions to the targets that motors are given; one thread at a time."""

    def __init__(self) -> None:
        self._low_pass, self.last = LowPass(), a1.STAND_JOINT_POS

    def reset(self, joint_pos: Array) -> None:
        """At rest at joint_pos (12,) rad."""
        self._low_pass.reset(joint_pos)
        self.last = joint_pos

    def step(self, action: ArrayLike) -> Array:
        """(12,) rad of an action (12,) rad: low-pass, then limits."""
        self.last = limit_target(self._low_pass.step(action), self.last)
        return self.last


def limit_target(target: ArrayLike, previous: ArrayLike | None = None) -> Array:
    """Targets (..., 12) rad within the joint limits and, given the previous ones, the joint speed.

    Applied last of all: a filter after a clip overshoots the limit it was clipped to. One period
    may move a target by at most SPEED_LIMIT * CONTROL_DT = 0.7 rad.
    """
    out = np.asarray(target, dtype=np.float64)
    if previous is not None:
        before = np.asarray(previous, dtype=np.float64)
        reach = a1.SPEED_LIMIT * a1.CONTROL_DT
        out = np.minimum(np.maximum(out, before - reach), before + reach)
    return np.minimum(np.maximum(out, a1.JOINT_LOWER), a1.JOINT_UPPER)
