"""The trained policies: one expert a state, the destination's in a transition it was trained on."""

from studio.control.policy import MODELS, Policy
from studio.control.trackers.tracker import Array, Situation, Tracker
from studio.errors import StudioError
from studio.reference.intent import STATES, StateName


def trained() -> bool:
    """There is a policy for every state."""
    return all(
        (MODELS / f"{state}{suffix}").is_file()
        for state in STATES
        for suffix in (".safetensors", ".json")
    )


class PolicyTracker(Tracker):
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

    def reset(self, now: Situation) -> None:
        """Fill the history of `state`'s policy with the present."""
        self._state = now.state
        self._policies[now.state].reset(now.reference, now.robot)

    def act(self, now: Situation) -> Array:
        """(12,) rad: the PD target of `state`'s policy."""
        policy = self._policies[now.state]
        if now.in_transition and not policy.manifest.get("transitions", False):
            self._state = None
            return now.reference.joint_pos
        if now.state != self._state:
            self.reset(now)
        return policy.action(now.reference, now.robot)
