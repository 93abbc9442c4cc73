"""The reference eases to neutral while the person is lost, and back to theirs."""

import numpy as np

from studio import geometry
from studio.geometry.time_scaling import smoothstep
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.mapper import Mapped

HOLD = 0.3
"""s given no pose before the reference eases to neutral. In the whole flow the last pose stands in
for those that do not come for another `control.staleness.STAND_AFTER` before, and the robot then
stands: easing only makes sure that the reference has come to rest when the person comes back."""
EASE = 0.6
"""s that easing to neutral (or back) takes."""


class Easing:
    """Remembers for how long nobody was seen, and how far the way to neutral has gone."""

    def __init__(self) -> None:
        self._silence, self._share = 0.0, 1.0

    def restart(self) -> None:
        """Ease from neutral into what the person does from here on."""
        self._share = 0.0

    def step(self, unknown: bool, seen: bool, dt: float) -> None:
        """`dt` s go by: towards neutral while the motion is unknown or nobody was `seen` for long,
        and back."""
        self._silence = 0.0 if seen else self._silence + dt
        lost = unknown or self._silence > HOLD
        self._share = min(max(self._share + (-dt if lost else dt) / EASE, 0.0), 1.0)

    def toward_neutral(self, mapped: Mapped, state: StateName) -> Mapped:
        """The mapped frame, blended to the state's neutral pose by how far that has gone."""
        s = smoothstep(self._share)
        if s >= 1.0:
            return mapped
        rest = NEUTRAL[state]
        return Mapped(
            joint_pos=rest.joint_pos + s * (mapped.joint_pos - rest.joint_pos),
            base_quat=geometry.quat_slerp(rest.base_quat, mapped.base_quat, np.float64(s)),
            rates=s * mapped.rates,
            contact_prob=rest.foot_contact + s * (mapped.contact_prob - rest.foot_contact),
            turn=None if mapped.turn is None else s * mapped.turn,
        )
