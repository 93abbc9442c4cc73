"""On three legs the trunk moves over the feet that carry it, and back."""

import numpy as np
import pytest

from studio import geometry
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.retarget.support_margin import MARGIN, RAMP_S, SupportMargin
from studio.robot import a1, kinematics
from studio.robot.support import support_distance

DT = a1.CONTROL_DT
LEVEL = np.zeros(2)
PAW_UP = {0: "manipulate_right", 1: "manipulate_left"}


def raised(paw):
    """The library's pose with that paw highest: joints (12,), trunk (4,), contact (4,)."""
    motion = realize(TASKS[PAW_UP[paw]].sample(np.random.default_rng(3), 10.0))
    feet = kinematics.foot_pos_w(motion.base_pos, motion.base_quat, motion.joint_pos)
    k = int(np.argmax(feet[:, paw, 2]))
    contact = np.ones(4)
    contact[paw] = 0.0
    return motion.joint_pos[k], motion.base_quat[k], contact


def over_the_side(joint_pos, quat, paw, slope=LEVEL):
    """m from what is under the centre of mass to the line of the feet beside the raised paw,
    inwards."""
    feet_3d = geometry.quat_rotate(quat, kinematics.foot_pos_b(joint_pos))
    com_3d = geometry.quat_rotate(quat, kinematics.center_of_mass_b(joint_pos))
    height = com_3d[2] - np.delete(feet_3d, paw, axis=0)[:, 2].mean()
    feet, com = feet_3d[:, :2], com_3d[:2] - height * slope
    contact = np.ones(4)
    contact[paw] = 0.0
    assert support_distance(com, feet, contact) == 0.0
    a, b = feet[1 - paw], feet[2 + paw]
    along = (b - a) / np.linalg.norm(b - a)
    return abs(along[0] * (com - a)[1] - along[1] * (com - a)[0])


@pytest.mark.parametrize("paw", [0, 1])
@pytest.mark.parametrize("ahead", [0.0, 0.1, -0.05])
def test_the_centre_of_mass_comes_to_the_margin_and_standing_feet_stay_together(paw, ahead):
    joint_pos, quat, contact = raised(paw)
    slope = np.array([ahead, 0.0])
    before = over_the_side(joint_pos, quat, paw, slope)
    support = SupportMargin()
    for _ in range(round(RAMP_S / DT) + 1):
        out = support.step(joint_pos, quat, contact, DT, slope)
    assert before < MARGIN - 0.005
    # The legs that move the trunk weigh something, too.
    assert over_the_side(out, quat, paw, slope) == pytest.approx(MARGIN, abs=0.012)
    own = slice(3 * paw, 3 * paw + 3)
    np.testing.assert_array_equal(out[own], joint_pos[own])
    standing = [i for i in range(4) if i != paw]
    was, now = (kinematics.foot_pos_b(q)[standing] for q in (joint_pos, out))
    np.testing.assert_allclose(now - now[0], was - was[0], atol=1e-6)  # one step of all three


def test_on_four_feet_nothing_changes_and_the_way_back_is_gradual():
    joint_pos, quat, contact = raised(0)
    support = SupportMargin()
    np.testing.assert_array_equal(support.step(joint_pos, quat, np.ones(4), DT, LEVEL), joint_pos)
    steps = [support.step(joint_pos, quat, contact, DT, LEVEL) for _ in range(12)]
    steps += [support.step(joint_pos, quat, np.ones(4), DT, LEVEL) for _ in range(12)]
    np.testing.assert_array_equal(steps[-1], joint_pos)
    assert np.abs(np.diff(steps, axis=0)).max() < np.radians(120.0) * DT


def test_two_raised_feet_are_no_stand_on_three():
    joint_pos, quat, _ = raised(0)
    trot = np.array([0.0, 1.0, 1.0, 0.0])
    np.testing.assert_array_equal(SupportMargin().step(joint_pos, quat, trot, DT, LEVEL), joint_pos)
