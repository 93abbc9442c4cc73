"""The reference's joint angles straight to the PD: what any policy has to beat."""

import numpy as np
from numpy.typing import NDArray

from studio.reference.intent import StateName
from studio.robot.pose import ReferencePose, RobotState


class PdPlayback:
    """Remembers nothing."""

    name = "pd_playback"

    def reset(self, reference: ReferencePose, robot: RobotState, state: StateName) -> None:
        """Nothing to forget."""

    def act(
        self,
        reference: ReferencePose,
        robot: RobotState,
        state: StateName,
        in_transition: bool,
    ) -> NDArray[np.float64]:
        """(12,) rad: the reference's joint angles."""
        return reference.joint_pos
