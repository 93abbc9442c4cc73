"""Stand: tilting, crouching and reaching with one front leg while the other feet carry."""

import numpy as np

from studio.retarget.states.expert import ExpertSpec

STAND = ExpertSpec(
    name="stand",
    covers="upright and leaning, twisting, shallow crouches, one arm (one paw) at a time",
    speed_limit=float(np.deg2rad(120.0)),
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
