"""The neutral pose of the current state whatever the reference does: the trivial baseline."""

import numpy as np

from studio.control.trackers.tracker import Array, Situation, Tracker
from studio.reference.stances import NEUTRAL
from studio.robot.a1 import CONTROL_DT

MAX_STEP = np.radians(115.0) * CONTROL_DT
"""rad per control period, so that leaving a state's neutral pose never is a jump."""


class StandStill(Tracker):
    """Remembers its last action."""

    name = "stand_still"

    def __init__(self) -> None:
        self._last: Array | None = None

    def reset(self, now: Situation) -> None:
        """The next action may be anything."""
        self._last = None

    def act(self, now: Situation) -> Array:
        """(12,) rad: neutral of `state`; in a transition the way to the next state's neutral."""
        goal = now.reference.joint_pos if now.in_transition else NEUTRAL[now.state].joint_pos
        if self._last is not None:
            goal = self._last + np.clip(goal - self._last, -MAX_STEP, MAX_STEP)
        self._last = goal
        return goal
