"""Sit: deep squats and sitting become a robot on its haunches with both front legs free."""

import numpy as np

from studio.reference.stances import JOINT_SPEED
from studio.retarget.states.expert import ExpertSpec

SIT = ExpertSpec(
    name="sit",
    speed_limit=JOINT_SPEED["sit"],
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
