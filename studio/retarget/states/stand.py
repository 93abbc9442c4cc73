"""Stand: tilting, crouching and reaching with one front leg while the other feet carry."""

import numpy as np

from studio.reference.stances import JOINT_SPEED
from studio.retarget.states.expert import ExpertSpec

STAND = ExpertSpec(
    name="stand",
    speed_limit=JOINT_SPEED["stand"],
    trunk_speed=float(np.deg2rad(75.0)),
    root_speed=0.2,
)
