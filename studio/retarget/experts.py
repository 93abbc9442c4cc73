"""The experts, one a state, apart from their weights: how fast joints may go, how feet lock."""

from dataclasses import dataclass, field

import numpy as np

from studio.reference.contact_lock import ContactConfig
from studio.reference.intent import StateName
from studio.reference.stances import JOINT_SPEED


@dataclass(frozen=True, kw_only=True)
class ExpertSpec:
    """One state's retargeting expert.

    name: the state. speed_limit: rad/s, bound on every joint's speed
    in the temporal consistency step (JOINT_SPEED). trunk_speed: rad/s and root_speed: m/s,
    the same for the trunk: a little less than the joints of standing legs can follow, so that the
    clip of the joints does not tear locked feet off the floor. consistency: how feet lock.
    turn_gain: times the turns that a network says. turns: the trunk's
    heading is carried by the feet (walking) instead of read off the person's twist.
    """

    name: StateName
    speed_limit: float
    trunk_speed: float
    root_speed: float
    consistency: ContactConfig = field(default_factory=ContactConfig)
    turn_gain: float = 1.0
    turns: bool = False


STAND = ExpertSpec(
    name="stand",
    speed_limit=JOINT_SPEED["stand"],
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
"""Tilting, crouching and reaching with one front leg while the other feet carry."""

WALK = ExpertSpec(
    name="walk",
    speed_limit=JOINT_SPEED["walk"],
    trunk_speed=float(np.deg2rad(180.0)),
    root_speed=1.5,
    # What a network says of a march is an average over people who step unlike: the root halts at
    # every step, swings scuff, turns come out short. Undone here: driven by four people to the
    # longest steps at 1.5 strides a second the simulated robot went 0.02 m/s, then 0.3.
    consistency=ContactConfig(regrip=0.10, clearance=0.07, steady=0.3, pull=0.05),
    turn_gain=1.5,
    turns=True,
)
"""Marching in place (or, by style, circling hands) becomes walking and turning."""

SIT = ExpertSpec(
    name="sit",
    speed_limit=JOINT_SPEED["sit"],
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
"""Deep squats and sitting become a robot on its haunches with both front legs free."""

EXPERTS: dict[StateName, ExpertSpec] = {"stand": STAND, "walk": WALK, "sit": SIT}
"""In the order in which votes are counted and shown."""
