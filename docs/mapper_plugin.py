r"""A mapper of one's own: the right hand's height sets how deep a standing robot crouches.

    a1-studio drive --source operator:manipulate_right --state stand \
        --mapper docs/mapper_plugin.py:Bow

`fit` is given pairs of synthetic people (`retarget.baselines.frames.Pairs`) and gives what
`retarget.mapper.Expert` asks for. This one keeps the mean hand, and needs no training beyond that.
"""

import numpy as np

from studio.errors import StudioError
from studio.human.features import FEATURE_NAMES
from studio.reference.stances import NEUTRAL
from studio.retarget.mapper import NUM_RATES, FrameByFrame, Mapped
from studio.robot import kinematics

HAND = FEATURE_NAMES.index("r_wrist.z")


class Bow(FrameByFrame):
    """The trunk sinks by 15 % of the hand's rise, at most 6 cm, over feet that stay."""

    def __init__(self, resting: float) -> None:
        self.resting = resting

    @classmethod
    def fit(cls, state, pairs, seed):
        if state != "stand":
            raise StudioError("Bow maps standing alone: use it with --state stand")
        return cls(float(np.median(pairs.triplet[:, HAND])))

    def begin(self):
        return self.map

    def map(self, triplet) -> Mapped:
        rest = NEUTRAL["stand"]
        down = np.clip(0.15 * (triplet[HAND] - self.resting), 0.0, 0.06)
        feet = kinematics.foot_pos_b(rest.joint_pos) + [0.0, 0.0, down]
        return Mapped(
            joint_pos=kinematics.leg_ik(feet)[0],
            base_quat=rest.base_quat,
            rates=np.zeros(NUM_RATES),
            contact_prob=rest.foot_contact,
        )
