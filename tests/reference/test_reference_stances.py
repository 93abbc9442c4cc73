"""Neutral poses stand on the floor, and tilts about them go there and back."""

import numpy as np
import pytest

from studio import geometry
from studio.reference import stances
from studio.reference.check import knee_pos_w
from studio.robot import a1, kinematics


@pytest.mark.parametrize("state", ["stand", "walk", "sit"])
def test_neutral_poses_touch_the_floor_with_their_lowest_sole(state):
    feet = stances.NEUTRAL_FEET[state]
    assert np.min(feet[:, 2]) == pytest.approx(a1.FOOT_RADIUS, abs=1e-9)
    pose = stances.NEUTRAL[state]
    assert np.all(pose.base_pos[:2] == 0.0)
    assert np.all(pose.joint_pos >= a1.JOINT_LOWER)
    assert np.all(pose.joint_pos <= a1.JOINT_UPPER)
    assert kinematics.self_collision_distance(pose.joint_pos) > 0.01


def test_neutral_stand_is_as_high_as_its_leg_triangle():
    # Thigh 0.895665 and calf twice back: 2 * 0.2 * cos(0.895665) = 0.25, plus the sole's 0.02.
    assert stances.NEUTRAL["stand"].base_pos[2] == pytest.approx(0.27, abs=1e-6)


def test_sitting_calves_lie_flat_and_carry_the_centre_of_mass_between_knee_and_foot():
    pose = stances.NEUTRAL["sit"]
    knee = knee_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos)[2:]
    foot = stances.NEUTRAL_FEET["sit"][2:]
    np.testing.assert_allclose(knee[:, 2], foot[:, 2], atol=1e-3)
    com = pose.base_pos + geometry.quat_rotate(
        pose.base_quat, kinematics.center_of_mass_b(pose.joint_pos)
    )
    assert knee[0, 0] + 0.04 < com[0] < foot[0, 0] - 0.10


@pytest.mark.parametrize("state", ["stand", "sit"])
def test_tilts_are_undone(state):
    tilt = np.random.default_rng(0).uniform(-0.6, 0.6, (50, 3))
    np.testing.assert_allclose(
        stances.tilt_of(state, stances.tilted(state, tilt)), tilt, atol=1e-12
    )


def test_bending_forward_lowers_the_nose_and_leaning_right_the_right_side():
    nose = geometry.quat_rotate(stances.tilted("sit", [0.0, 0.2, 0.0]), [1.0, 0.0, 0.0])
    rest = geometry.quat_rotate(stances.NEUTRAL["sit"].base_quat, [1.0, 0.0, 0.0])
    assert nose[2] < rest[2] - 0.05
    right = geometry.quat_rotate(stances.tilted("stand", [0.2, 0.0, 0.0]), [0.0, -1.0, 0.0])
    assert right[2] == pytest.approx(-np.sin(0.2))
