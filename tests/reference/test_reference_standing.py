"""Standing poses: the tilts of the paper, the crouch and the raised paw, over feet that stay."""

import numpy as np
import pytest

from studio import geometry
from studio.reference import stances, standing
from studio.robot import kinematics


def pose(tilt=(0, 0, 0), crouch=0.0, reach=(0, 0), side=(0, 0)):
    base, quat, joints = standing.stand_poses(
        np.array([tilt], dtype=float),
        np.array([crouch]),
        np.array([reach], dtype=float),
        np.array([side], dtype=float),
    )
    return base[0], quat[0], joints[0]


def test_rest_is_the_neutral_stand():
    base, quat, joints = pose()
    neutral = stances.NEUTRAL["stand"]
    np.testing.assert_allclose(base, neutral.base_pos, atol=1e-6)
    np.testing.assert_allclose(quat, neutral.base_quat, atol=1e-12)
    np.testing.assert_allclose(joints, neutral.joint_pos, atol=1e-6)


@pytest.mark.parametrize("axis", [0, 1, 2])
@pytest.mark.parametrize("degrees", [-40.0, 40.0])
def test_forty_degrees_are_reached_on_every_axis_with_all_feet_in_place(axis, degrees):
    tilt = np.zeros(3)
    tilt[axis] = np.radians(degrees)
    base, quat, joints = pose(tilt)
    np.testing.assert_allclose(stances.tilt_of("stand", quat), tilt, atol=1e-9)
    feet = kinematics.foot_pos_w(base, quat, joints)
    np.testing.assert_allclose(feet, stances.NEUTRAL_FEET["stand"], atol=5e-4)
    assert 0.22 <= base[2] <= 0.26
    assert kinematics.self_collision_distance(joints) > 0.0


def test_a_tilt_beyond_the_legs_is_scaled_down_instead_of_lifting_feet():
    tilt = np.radians([40.0, 40.0, 40.0])
    base, quat, joints = pose(tilt)
    feet = kinematics.foot_pos_w(base, quat, joints)
    np.testing.assert_allclose(feet, stances.NEUTRAL_FEET["stand"], atol=6e-4)
    reached = stances.tilt_of("stand", quat)
    np.testing.assert_allclose(reached / tilt, np.mean(reached / tilt), atol=1e-6)
    assert 0.3 < np.mean(reached / tilt) < 1.0


def test_crouching_lowers_the_trunk_by_more_than_eight_centimetres():
    assert pose(crouch=1.0)[0][2] == pytest.approx(0.27 - 0.085)
    assert pose(crouch=0.5)[0][2] == pytest.approx(0.27 - 0.0425)


@pytest.mark.parametrize("paw", [0, 1])
def test_a_full_raise_brings_the_paw_high_and_the_weight_over_the_other_feet(paw):
    reach = np.zeros(2)
    reach[paw] = 1.0
    base, quat, joints = pose(reach=reach)
    feet = kinematics.foot_pos_w(base, quat, joints)
    assert feet[paw, 2] > 0.35
    others = [leg for leg in range(4) if leg != paw]
    np.testing.assert_allclose(feet[others], stances.NEUTRAL_FEET["stand"][others], atol=5e-4)
    com = base + geometry.quat_rotate(quat, kinematics.center_of_mass_b(joints))
    # The long side of the triangle is the diagonal through the origin and the other front foot.
    front = feet[1 - paw, :2]
    normal = np.array([-front[1], front[0]]) / np.linalg.norm(front)
    inside = abs(com[:2] @ normal)
    assert inside > 0.04


@pytest.mark.parametrize("side", [-1.0, 0.0, 1.0])
def test_a_paw_held_to_the_side_stays_above_twelve_centimetres(side):
    base, quat, joints = pose(reach=(1.0, 0.0), side=(side, 0.0))
    assert kinematics.foot_pos_w(base, quat, joints)[0, 2] > 0.15


def test_half_a_reach_to_the_left_puts_the_paw_left_of_half_a_reach_to_the_right():
    left, right = (
        kinematics.foot_pos_w(*pose(reach=(0.6, 0.0), side=(s, 0.0)))[0, 1] for s in (1.0, -1.0)
    )
    assert left > right + 0.1


def test_both_arms_up_leave_both_paws_down_and_one_leading_is_raised():
    np.testing.assert_array_equal(standing.reach_on_three_feet(np.array([[0.8, 0.8]])), 0.0)
    np.testing.assert_allclose(standing.reach_on_three_feet(np.array([[0.9, 0.1]])), [[0.9, 0.0]])


def test_poses_move_continuously_with_the_reach():
    reach = np.stack([np.linspace(0.0, 1.0, 400), np.zeros(400)], axis=-1)
    zero = np.zeros((400, 2))
    joints = standing.stand_poses(np.zeros((400, 3)), np.zeros(400), reach, zero)[2]
    assert np.max(np.abs(np.diff(joints, axis=0))) < 0.03
