"""References of another state machine, period by period, and the way to a stand when they end.

The robot's side of a link has it: a line that breaks in mid-stride leaves nobody else to say how
the feet come down.
"""

import numpy as np
from numpy.typing import NDArray

from studio.control.drive_command import Directive
from studio.control.footing import still
from studio.control.state_machine import Decision, StateMachine
from studio.control.stopping import in_the_air
from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose

Array = NDArray[np.float64]


class StandBy(StateMachine):
    """One thread only."""

    def see(self, reference: ReferencePose, expert: StateName, in_transition: bool) -> None:
        """The reference of this period, tracked by `expert`; in_transition: on the planned way into
        its state."""
        self.state, self.reference, self._last = expert, reference, still(reference)
        self._path, self._stopping, self._settling = None, None, 0
        self._following, self._rested = True, False
        walks = expert == "walk" and not in_transition
        self._strides.see(self._last if walks else None)
        if not in_transition:
            self._settled_in = expert
        self._between = {expert, self._settled_in} if in_transition else set()

    def come_to_stand(self) -> Decision:
        """The next period of the way to a stand, which begins with the first call."""
        if self._between:
            seated = "sit" in self._between and bool(in_the_air(self._last)[:2].any())
            self._begin("stand", "sit" if seated else "stand")
            self._changes_state, self._between = True, set()
        return self.step("stand", None, Directive.STAND)

    def reset(self, state: StateName, base_xy: Array | None = None, yaw: float = 0.0) -> None:
        """As the state machine's."""
        super().reset(state, base_xy, yaw)
        self._settled_in: StateName = state
        self._between: set[StateName] = set()

    @property
    def stands(self) -> bool:
        """It has come to a stand."""
        return self.state == "stand" and self._rested and not self.busy
