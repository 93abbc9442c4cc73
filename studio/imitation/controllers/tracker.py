"""What every controller is: a name, a reset, and an action for each control period."""

from typing import Protocol

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]


class Tracker(Protocol):
    """Makes the robot track a reference. Only the control loop's thread calls it."""

    name: str

    def reset(self, reference: ReferencePose, robot: RobotState, state: StateName) -> None:
        """Forget the past: the robot was placed anew."""
        ...

    def act(
        self,
        reference: ReferencePose,
        robot: RobotState,
        state: StateName,
        in_transition: bool,
    ) -> Array:
        """PD targets (12,) rad, before low-pass and limits.

        state: the expert in charge; in a transition that of the destination.
        """
        ...
