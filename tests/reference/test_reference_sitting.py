"""Sitting poses: rear feet pinned, a knee on the floor, paws from low to above 0.8 m."""

import numpy as np
import pytest

from studio.reference import sitting, stances
from studio.reference.check import knee_pos_w
from studio.robot import kinematics


def poses(tilt, reach=(0.0, 0.0), side=(0.0, 0.0)):
    tilt = np.atleast_2d(np.asarray(tilt, dtype=float))
    count = len(tilt)
    return sitting.sit_poses(tilt, np.tile(reach, (count, 1)), np.tile(side, (count, 1)))


def test_rest_is_the_neutral_sit():
    base, quat, joints = poses([0, 0, 0])
    neutral = stances.NEUTRAL["sit"]
    np.testing.assert_allclose(base[0], neutral.base_pos, atol=1e-3)
    np.testing.assert_allclose(quat[0], neutral.base_quat, atol=1e-12)
    np.testing.assert_allclose(joints[0], neutral.joint_pos, atol=5e-3)


def test_every_tilt_keeps_rear_feet_in_place_and_rests_on_the_lower_knee():
    tilt = np.random.default_rng(1).uniform(-1.0, 1.0, (200, 3)) * sitting.TILT_LIMIT
    base, quat, joints = poses(tilt)
    feet = kinematics.foot_pos_w(base, quat, joints)
    np.testing.assert_allclose(feet[:, 2:] - stances.NEUTRAL_FEET["sit"][2:], 0.0, atol=1e-6)
    knees = knee_pos_w(base, quat, joints)[:, 2:, 2]
    lowest = np.min(knees, axis=-1)
    assert np.all(lowest > 0.016)
    assert np.all(lowest < 0.024)
    np.testing.assert_allclose(stances.tilt_of("sit", quat), tilt, atol=1e-9)


def test_raised_paws_reach_above_eighty_centimetres_and_resting_ones_hang_low():
    high = kinematics.foot_pos_w(*poses([0, 0, 0], reach=(1.0, 1.0)))[0]
    low = kinematics.foot_pos_w(*poses([0, 0, 0]))[0]
    assert np.all(high[:2, 2] > 0.8)
    assert np.all(low[:2, 2] < 0.35)
    assert np.all(low[:2, 0] > 0.15)


def test_each_paw_follows_its_own_arm_and_a_standing_robot_cannot_reach_as_high():
    feet = kinematics.foot_pos_w(*poses([0, 0, 0], reach=(1.0, 0.0)))[0]
    assert feet[0, 2] > 0.8
    assert feet[1, 2] < 0.35


def test_tilts_beyond_the_range_are_clipped():
    beyond = poses([0.0, 1.0, 0.0])[1]
    np.testing.assert_allclose(beyond, poses([0.0, np.radians(15.0), 0.0])[1], atol=1e-12)


def test_a_sideways_arm_moves_the_paw_aside():
    left, right = (
        kinematics.foot_pos_w(*poses([0, 0, 0], reach=(0.5, 0.0), side=(s, 0.0)))[0, 0, 1]
        for s in (1.0, -1.0)
    )
    assert left - right == pytest.approx(0.2, abs=0.1)
