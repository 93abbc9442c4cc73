"""What is not seen of a person eases to neutral: the reference stays sane, the robot stays up."""

from contextlib import closing
from dataclasses import replace

import numpy as np
import pytest

from studio.evaluation.behind import drive, met
from studio.human.pose import HumanPose
from studio.human.skeleton import INDEX
from studio.robot import kinematics
from studio.robot.a1 import FOOT_RADIUS
from studio.sources import open_source
from studio.synthetic.impaired import Impaired, Impairment, SensorBefore
from studio.takes.tick import Tick

LEGS = ("knee", "ankle", "toe")
ARMS = ("elbow", "wrist")


class Hides(SensorBefore):
    """Sees nothing of joints whose names have one of `parts` in them."""

    def __init__(self, *parts: str) -> None:
        self.hidden = [i for name, i in INDEX.items() if any(part in name for part in parts)]
        assert self.hidden

    def see(self, pose: HumanPose) -> HumanPose:
        place, sure = np.array(pose.joint_pos_w), np.array(pose.confidence)
        place[self.hidden], sure[self.hidden] = 0.0, 0.0
        return replace(pose, joint_pos_w=place, confidence=sure)


def driven(spec: str, *parts: str, seconds: float = 20.0) -> list[Tick]:
    with closing(open_source(spec, seed=3)) as person:
        seen = Impaired(person, Impairment(), 0, Hides(*parts))
        return list(drive(met(seen), seen, seconds))


def paws(ticks: list[Tick]) -> np.ndarray:
    """(T, 2) m, heights of the reference's front soles."""
    poses = [tick.reference for tick in ticks]
    base, quat, joints = (
        np.array([getattr(p, name) for p in poses])
        for name in ("base_pos", "base_quat", "joint_pos")
    )
    return kinematics.foot_pos_w(base, quat, joints)[:, :2, 2] - FOOT_RADIUS


@pytest.mark.parametrize(
    "parts", [("ankle", "toe"), LEGS, ARMS, ("l_",), ("r_knee", "r_ankle", "r_toe"), ("hip", *LEGS)]
)
@pytest.mark.parametrize(
    "spec", ["operator:walk", "operator:sit_tilt", "operator:manipulate_right"]
)
def test_nobody_who_is_seen_in_part_fells_the_robot(spec, parts):
    ticks = driven(spec, *parts)
    assert not any(tick.fallen for tick in ticks)
    joints = np.array([tick.reference.joint_pos for tick in ticks])
    assert np.isfinite(joints).all()


def test_legs_that_are_never_seen_neither_walk_nor_sit():
    for spec in ("operator:walk", "operator:sit_tilt"):
        ticks = driven(spec, *LEGS)
        assert {tick.expert for tick in ticks[15:]} == {"stand"}


def test_arms_that_are_never_seen_lift_no_paw():
    seen = paws(driven("operator:manipulate_right", "head"))
    unseen = paws(driven("operator:manipulate_right", *ARMS))
    assert seen.max() > 0.08
    assert unseen.max() < 0.03
