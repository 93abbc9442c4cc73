"""How the floor slopes, from how a robot on four feet stands on it beside its reference.

The reference's floor is level. A robot that repeats a reference to a degree or two leans off it by
the floor's slope; whoever knows that keeps the centre of mass over the feet that are left.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.state_machine import StateMachine
from studio.robot import a1
from studio.robot.pose import RobotState

Array = NDArray[np.float64]

SMOOTH_S = 0.7
"""Time constant of the mean: a sway takes about as long."""
STANDING = 0.6
"""Contact from which a foot stands."""
STEEPEST = 0.3
"""The floor is taken to rise by no more: who leans so far is not standing on it."""
_UP = np.array([0.0, 0.0, 1.0])


class FloorSlope:
    """Remembers the slope, level at first. One thread."""

    def __init__(self) -> None:
        self.slope: Array = np.zeros(2)

    def see(self, machine: StateMachine, robot: RobotState) -> Array:
        """(2,) m that the floor rises a metre along x and y of the reference's world.

        machine, robot: with the reference of the last control period and what became of it. What is
        felt on fewer than four standing feet changes nothing.
        """
        reference = machine.reference
        on_four = machine.state == "stand" and not machine.in_transition
        if on_four and reference.foot_contact.min() > STANDING:
            up_b = geometry.quat_rotate_inverse(robot.base_quat, _UP)
            up = geometry.quat_rotate(reference.base_quat, up_b)
            felt = np.clip(up[:2] / max(float(up[2]), 1e-6), -STEEPEST, STEEPEST)
            if np.isfinite(felt).all():
                self.slope = self.slope + (felt - self.slope) * min(a1.CONTROL_DT / SMOOTH_S, 1.0)
        return self.slope
