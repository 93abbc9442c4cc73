"""Walk: marching in place (or, by style, circling hands) becomes walking and turning."""

import numpy as np

from studio.reference.consistency import ContactConfig
from studio.retarget.states.expert import ExpertSpec

WALK = ExpertSpec(
    name="walk",
    covers="marching and jogging in place, turning while marching",
    # A trot's joints reach 330 to 830 deg/s; at the paper's 120 its feet err 5 to 13 cm.
    speed_limit=float(np.deg2rad(900.0)),
    trunk_speed=float(np.deg2rad(180.0)),
    root_speed=1.5,
    # What a network says of a march is an average over people who step unlike: the root halts at
    # every step, swings scuff, turns come out short. Undone here: driven by four people to the
    # longest steps at 1.5 strides a second the simulated robot went 0.02 m/s, then 0.3.
    consistency=ContactConfig(regrip=0.10, clearance=0.07, steady=0.3, pull=0.05),
    turn_gain=1.5,
    turns=True,
)
