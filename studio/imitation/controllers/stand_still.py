"""The neutral pose of the current state whatever the reference does: the trivial baseline."""

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotState

MAX_STEP = np.radians(115.0) * CONTROL_DT
"""rad per control period, so that leaving a state's neutral pose never is a jump."""


class StandStill:
    """Remembers its last action."""

    name = "stand_still"

    def __init__(self) -> None:
        self._last: NDArray[np.float64] | None = None

    def reset(self, reference: ReferencePose, robot: RobotState, state: StateName) -> None:
        """The next action may be anything."""
        self._last = None

    def act(
        self,
        reference: ReferencePose,
        robot: RobotState,
        state: StateName,
        in_transition: bool,
    ) -> NDArray[np.float64]:
        """(12,) rad: neutral of `state`; in a transition the way to the next state's neutral."""
        goal = reference.joint_pos if in_transition else NEUTRAL[state].joint_pos
        if self._last is not None:
            goal = self._last + np.clip(goal - self._last, -MAX_STEP, MAX_STEP)
        self._last = goal
        return goal
