"""Walk: marching in place (or, by style, circling hands) becomes walking and turning."""

import numpy as np

from studio.reference.consistency import ContactConfig
from studio.reference.stances import JOINT_SPEED
from studio.retarget.states.expert import ExpertSpec

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
