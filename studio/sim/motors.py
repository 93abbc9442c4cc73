"""The motors' torque-speed curve, one for the live robot and for those that policies train on."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class MotorModel:
    """How a motor's torque falls with speed (back-EMF): torque <= slope (free speed - qd) forwards,
    the same backwards, so that beyond the free speed it brakes.

    free_speed: where it has no torque left, rad/s; a little under the limit of 21, as links drag
    each other along. speed_slope: N m per rad/s: full torque below 8 rad/s. A free calf has
    0.017 kg m^2: were it steeper, one physics step at full torque would carry it past the limit.
    """

    free_speed: float = 19.0
    speed_slope: float = 3.0

    def full_below(self, torque_limit: ArrayLike) -> float:
        """rad/s up to which every motor of these limits, N m, has its whole torque."""
        return self.free_speed - float(np.max(torque_limit)) / self.speed_slope

    def torques(
        self, speed: Array, backward: ArrayLike = np.inf, forward: ArrayLike = np.inf
    ) -> tuple[Array, Array]:
        """Least and largest torque, N m, at speeds (...) rad/s. backward, forward: rad/s (...), the
        free speed where something else holds a joint to less."""
        largest = self.speed_slope * (np.minimum(self.free_speed, forward) - speed)
        least = self.speed_slope * (np.maximum(-self.free_speed, -np.asarray(backward)) - speed)
        return least, largest
