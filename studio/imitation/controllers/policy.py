"""The trained policies: one expert a state, the destination's in a transition."""

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.errors import StudioError
from studio.reference.intent import STATES, StateName
from studio.robot.pose import ReferencePose, RobotState

MODELS = Path(__file__).resolve().parents[3] / "models" / "policy"


def trained() -> bool:
    """There is a policy for every state."""
    return all((MODELS / f"{state}.safetensors").is_file() for state in STATES)


class PolicyTracker:
    """Remembers the observation history of the policy in charge."""

    name = "policy"

    def __init__(self) -> None:
        if not trained():
            raise StudioError(
                "no trained policy for every state in models/policy: run `a1-studio train policy "
                "--state stand|walk|sit`, or choose --controller pd_playback"
            )
        from studio.imitation.policy import Policy

        self._policies = {state: Policy.load(state) for state in STATES}
        self._state: StateName | None = None

    def reset(self, reference: ReferencePose, robot: RobotState, state: StateName) -> None:
        """Fill the history of `state`'s policy with the present."""
        self._state = state
        self._policies[state].reset(reference, robot)

    def act(
        self,
        reference: ReferencePose,
        robot: RobotState,
        state: StateName,
        in_transition: bool,
    ) -> NDArray[np.float64]:
        """(12,) rad: the PD target of `state`'s policy."""
        if state != self._state:
            self.reset(reference, robot, state)
        return self._policies[state].action(reference, robot)
