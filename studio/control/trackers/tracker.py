"""What every controller is: a name, a reset, and an action for each control period."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Situation:
    """What a controller acts on.

    reference: to be tracked. robot: as it is now. state: the expert in charge, in a transition
    that of the destination. in_transition: on the planned way between two states.
    """

    reference: ReferencePose
    robot: RobotState
    state: StateName
    in_transition: bool = False


class Tracker(ABC):
    """Makes the robot track a reference. Only the control loop's thread calls it."""

    name: str

    def reset(self, now: Situation) -> None:  # noqa: B027 - most remember nothing
        """Forget the past: the robot was placed anew."""

    @abstractmethod
    def act(self, now: Situation) -> Array:
        """PD targets (12,) rad, before low-pass and limits."""
