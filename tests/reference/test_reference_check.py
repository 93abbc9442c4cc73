"""The checker finds what is wrong: each way of spoiling a good motion is named."""

from dataclasses import replace

import numpy as np
import pytest

from studio.reference.check import check
from studio.reference.library import TASKS
from studio.reference.realize import realize
from studio.robot import kinematics


@pytest.fixture(scope="module")
def stand():
    return realize(TASKS["crouch"].sample(np.random.default_rng(0), 3.0))


@pytest.fixture(scope="module")
def crawl():
    return realize(TASKS["walk"].sample(np.random.default_rng(2), 6.0))


def spoiled(motion, **changes):
    return check(replace(motion, **changes))


def test_good_motions_have_no_problems(stand, crawl):
    assert check(stand) == []
    assert check(crawl) == []


def test_joints_past_their_limits_are_named(stand):
    joints = stand.joint_pos.copy()
    joints[40:, 5] = -0.5  # FL_calf ends at -0.916
    problems = spoiled(stand, joint_pos=joints)
    assert any("FL_calf is 0.416 rad past its limit" in p for p in problems)
    assert any("degrees a second" in p for p in problems)


def test_not_a_number_is_a_problem(stand):
    joints = stand.joint_pos.copy()
    joints[3, 3] = np.nan
    assert spoiled(stand, joint_pos=joints)[0] == "joint angles are not finite"


def test_a_walk_played_as_a_stand_is_too_fast(crawl):
    assert any("of 120 degrees a second" in p for p in spoiled(crawl, state="stand"))


def test_sinking_floating_and_sliding_feet_are_named(stand):
    sunk = stand.base_pos - [0.0, 0.0, 0.01]
    assert any("below the floor" in p for p in spoiled(stand, base_pos=sunk))
    risen = stand.base_pos + [0.0, 0.0, 0.01]
    assert any("above the floor" in p for p in spoiled(stand, base_pos=risen))
    drift = stand.base_pos + np.outer(np.arange(len(stand)) * 0.002, [1.0, 0.0, 0.0])
    assert any("slides at 0.060 m/s" in p for p in spoiled(stand, base_pos=drift))


def test_two_feet_are_too_few_to_stand_on(stand):
    contact = stand.foot_contact.copy()
    contact[:, :2] = 0.0
    assert any("only 2 supports" in p for p in spoiled(stand, foot_contact=contact))


def test_a_centre_of_mass_outside_the_feet_is_named(stand):
    contact = stand.foot_contact.copy()
    contact[:, 0] = 0.0  # the weight is not on the three others: it lies on their diagonal
    base = stand.base_pos.copy()
    feet = kinematics.foot_pos_w(base, stand.base_quat, stand.joint_pos)
    base[:, :2] += [0.04, -0.04]
    joints = kinematics.leg_ik(feet - base[:, None])[0]
    motion = replace(stand, base_pos=base, joint_pos=joints, foot_contact=contact)
    motion = replace(motion, base_quat=np.tile([1.0, 0.0, 0.0, 0.0], (len(base), 1)))
    assert any("centre of mass" in p for p in check(motion))


def test_a_crawl_without_its_sway_is_out_of_balance(crawl):
    feet = kinematics.foot_pos_w(crawl.base_pos, crawl.base_quat, crawl.joint_pos)
    base = crawl.base_pos.copy()
    base[:, 1] = -2.0 * base[:, 1]
    joints = kinematics.leg_ik(feet - base[:, None])[0]
    problems = spoiled(crawl, base_pos=base, joint_pos=joints)
    assert any("zero moment point" in p for p in problems)


def test_crossed_legs_overlap(stand):
    joints = stand.joint_pos.copy()
    joints[:, 0], joints[:, 3] = 0.8, -0.8
    assert any("links overlap" in p for p in spoiled(stand, joint_pos=joints))
