"""What turns a reference into an action, by name: stand still, PD playback, trained policies."""

from abc import ABC, abstractmethod
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.control.policy import MODELS, Policy
from studio.errors import StudioError, unknown_name
from studio.reference.intent import STATES, StateName
from studio.reference.stances import JOINT_SPEED, NEUTRAL
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]

MAX_STEP = (JOINT_SPEED["stand"] - np.radians(5.0)) * CONTROL_DT
"""rad per control period, so that leaving a state's neutral pose never is a jump."""


@dataclass(frozen=True, kw_only=True)
class ControllerInput:
    """What a controller acts on.

    reference: to be tracked. robot: as it is now. state: the expert in charge, in a transition
    that of the destination. in_transition: on the planned way between two states.
    """

    reference: ReferencePose
    robot: RobotState
    state: StateName
    in_transition: bool = False


class Controller(ABC):
    """Makes the robot track a reference. Only the control loop's thread calls it."""

    name: str

    def reset(self, now: ControllerInput) -> None:  # noqa: B027 - most remember nothing
        """Forget the past: the robot was placed anew."""

    @abstractmethod
    def act(self, now: ControllerInput) -> Array:
        """PD targets (12,) rad, before low-pass and limits."""


class StandStill(Controller):
    """The state's neutral pose whatever the reference does: the trivial baseline.

    Remembers its last action.
    """

    name = "stand_still"

    def __init__(self) -> None:
        self._last: Array | None = None

    def reset(self, now: ControllerInput) -> None:
        """The next action may be anything."""
        self._last = None

    def act(self, now: ControllerInput) -> Array:
        """(12,) rad: neutral of `state`; in a transition the way to the next state's neutral."""
        goal = now.reference.joint_pos if now.in_transition else NEUTRAL[now.state].joint_pos
        if self._last is not None:
            goal = self._last + np.clip(goal - self._last, -MAX_STEP, MAX_STEP)
        self._last = goal
        return goal


class PdPlayback(Controller):
    """The reference's joint angles straight to the PD: what any policy has to beat."""

    name = "pd_playback"

    def act(self, now: ControllerInput) -> Array:
        """(12,) rad: the reference's joint angles."""
        return now.reference.joint_pos


def trained() -> bool:
    """There is a policy for every state."""
    return all(
        (MODELS / f"{state}{suffix}").is_file()
        for state in STATES
        for suffix in (".safetensors", ".json")
    )


class PolicyController(Controller):
    """Remembers the observation history of the policy in charge.

    A policy whose sidecar does not say `"transitions": true` has never seen the way into its
    state: there the planned joints go straight to the PD.
    """

    name = "policy"

    def __init__(self, policies: dict[StateName, Policy] | None = None) -> None:
        """The shipped policies, or those given. StudioError where one is missing or damaged."""
        if policies is None and not trained():
            raise StudioError(
                "no trained policy for every state in models/policy: run `a1-studio train policy "
                "--state stand|walk|sit`, or choose --controller pd_playback"
            )
        self._policies = policies or {state: Policy.load(state) for state in STATES}
        self._state: StateName | None = None

    def reset(self, now: ControllerInput) -> None:
        """Fill the history of `state`'s policy with the present."""
        self._state = now.state
        self._policies[now.state].reset(now.reference, now.robot)

    def act(self, now: ControllerInput) -> Array:
        """(12,) rad: the PD target of `state`'s policy."""
        policy = self._policies[now.state]
        if now.in_transition and not policy.manifest.get("transitions", False):
            self._state = None
            return now.reference.joint_pos
        if now.state != self._state:
            self.reset(now)
        return policy.action(now.reference, now.robot)


CONTROLLERS: dict[str, Callable[[], Controller]] = {
    "stand_still": StandStill,
    "pd_playback": PdPlayback,
    "policy": PolicyController,
}


def default_controller() -> str:
    """ "policy" once one is trained for every state, "pd_playback" until then."""
    return "policy" if trained() else "pd_playback"


def open_controller(name: str | None = None) -> Controller:
    """The controller called `name` (None: the default one).

    StudioError for an unknown name, or for "policy" where no policy is trained.
    """
    name = name or default_controller()
    if name not in CONTROLLERS:
        raise unknown_name("controller", name, CONTROLLERS)
    return CONTROLLERS[name]()
