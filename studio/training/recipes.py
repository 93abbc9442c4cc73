"""What each state's policy is trained with: recipes, and lessons; in which stages, `stages`."""

from dataclasses import dataclass
from typing import Literal

PolicyName = Literal["stand", "walk", "sit", "all"]
"""An expert's state, or "all": one monolithic policy of every state."""


@dataclass(frozen=True, kw_only=True)
class Recipe:
    """What one expert is trained with unless told otherwise.

    heading_gain: 1/s, and heading_smooth: s, see `observation.History`; who sits turns
    by 3.5 degrees, which is less than the reference's noise. A walk's heading
    steers only as its mean over a second: within a stride it excited the gait until the robot fell
    (`evaluate endurance`). init_heading, steep: see EnvConfig.
    anchor_tau, anchor_yaw_tau: s, see EnvConfig: walking at 0.5 s, a speed that is 0.08 m/s short
    costs 3 % of the reward, at 3 s 68 %; sitting at 0.5 s, nothing asks for a trunk that stays
    turned. noise_low: rad, least σ of the reference noise: a
    policy that has only met noise reads small tilts as noise. root_ori: scale of that reward term.
    unrest: how much of a motion that went before
    the trunk may still have at the start, as a share of a walk's: a robot that sits down stood.
    travels: motions through space for each of another task. mirror_loss: see PpoConfig; the weights
    then run symmetric (`policy.Symmetric`), or a robot that is asked to walk straight turns by some
    degrees a second.
    """

    heading_gain: float = 0.0
    heading_smooth: float = 0.0
    init_heading: float = 0.3
    steep: float = 0.0
    anchor_tau: float = 0.5
    anchor_yaw_tau: float = 0.5
    noise_low: float = 0.0
    root_ori: float = 5.0
    unrest: float = 1.0
    mirror_loss: float = 1.0
    motors: bool = False
    travels: int = 0


RECIPES: dict[PolicyName, Recipe] = {
    "stand": Recipe(),
    "walk": Recipe(
        heading_gain=0.6,
        heading_smooth=1.0,
        anchor_tau=3.0,
        anchor_yaw_tau=5.0,
        steep=0.3,
        motors=True,
        travels=3,
    ),
    "sit": Recipe(
        heading_gain=1.0,
        init_heading=0.05,
        anchor_yaw_tau=10.0,
        root_ori=80.0,
        unrest=0.3,
        steep=0.4,
    ),
    "all": Recipe(),
}
TAUGHT: dict[PolicyName, int] = {"stand": 800_000, "walk": 800_000, "sit": 0, "all": 800_000}
"""Samples learnt from the analytic teacher before PPO. Sitting, that teacher itself falls on slopes
(success .88 against .99 of PPO's policy): it has no sense of balance, and four feet need none."""
BEGUN_FIRST = 0.3
"""Share of the episodes that begin at a motion's first frame, where motions lead out of others."""
UNREST_SPEED, UNREST_SPIN = 0.6, 1.0
"""m/s and rad/s, largest, that half of the trunks have there on top: times a recipe's `unrest`."""
