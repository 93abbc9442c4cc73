"""Sit: deep squats and sitting become a robot on its haunches with both front legs free."""

import numpy as np

from studio.retarget.states.expert import ExpertSpec

SIT = ExpertSpec(
    name="sit",
    covers="deep squats and sitting, tilting there, both arms (both paws) at once",
    speed_limit=float(np.deg2rad(120.0)),
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
