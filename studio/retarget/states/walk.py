"""Walk: marching in place (or, by style, circling hands) becomes walking and turning."""

import numpy as np

from studio.retarget.states.expert import ExpertSpec

WALK = ExpertSpec(
    name="walk",
    covers="marching and jogging in place, turning while marching",
    # A trot's joints reach 330 to 830 deg/s; at the paper's 120 its feet err 5 to 13 cm.
    speed_limit=float(np.deg2rad(900.0)),
    trunk_speed=float(np.deg2rad(180.0)),
    root_speed=1.5,
    # A swing that the contacts missed leaves a foot behind: planted joint errors 11.8 -> 9.0 deg.
    regrip=0.05,
    turns=True,
)
