"""Closed-form legs against finite differences, each other and numbers worked out by hand."""

import numpy as np
import pytest

from studio import geometry
from studio.robot import a1, kinematics


def random_joints(n: int, seed: int = 0) -> np.ndarray:
    return np.random.default_rng(seed).uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (n, 12))


def test_foot_of_a_straight_leg_is_where_the_tape_measure_says():
    joint_pos = np.zeros(12)
    # straight down: thigh 0.2 + calf 0.2; sideways hip 0.047 + thigh 0.0838
    expected = [[0.1805, -0.1308, -0.4], [0.1805, 0.1308, -0.4]]
    expected += [[-0.1805, -0.1308, -0.4], [-0.1805, 0.1308, -0.4]]
    np.testing.assert_allclose(kinematics.foot_pos_b(joint_pos), expected, atol=1e-12)


def test_thigh_forward_ninety_degrees_moves_the_foot_forward():
    joint_pos = np.tile([0.0, -np.pi / 2, 0.0], 4)
    # both links along +x: 0.1805 + 0.4
    np.testing.assert_allclose(
        kinematics.foot_pos_b(joint_pos)[0], [0.5805, -0.1308, 0.0], atol=1e-12
    )


def test_neutral_stand_has_each_foot_under_its_thigh_and_the_sole_on_the_floor():
    foot = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    np.testing.assert_allclose(foot[:, 0], a1.HIP_OFFSET[:, 0], atol=1e-6)
    np.testing.assert_allclose(foot[:, 2], a1.FOOT_RADIUS - a1.STAND_HEIGHT, atol=1e-6)


def test_ik_inverts_fk_everywhere_within_the_limits():
    joint_pos = random_joints(5000)
    solved, error = kinematics.leg_ik(kinematics.foot_pos_b(joint_pos), near=joint_pos)
    np.testing.assert_allclose(solved, joint_pos, atol=1e-9)
    assert np.max(error) < 1e-12


def test_ik_without_a_hint_still_reaches_every_reachable_foot():
    foot = kinematics.foot_pos_b(random_joints(5000, seed=1))
    solved, error = kinematics.leg_ik(foot)
    assert np.max(error) < 1e-9
    np.testing.assert_allclose(kinematics.foot_pos_b(solved), foot, atol=1e-9)


def test_ik_of_any_target_stays_within_limits_and_reports_the_distance_left():
    foot = np.random.default_rng(2).uniform(-1.0, 1.0, (2000, 4, 3))
    solved, error = kinematics.leg_ik(foot)
    assert np.all(solved >= a1.JOINT_LOWER - 1e-12)
    assert np.all(solved <= a1.JOINT_UPPER + 1e-12)
    gap = np.linalg.norm(kinematics.foot_pos_b(solved) - foot, axis=-1)
    np.testing.assert_allclose(error, gap, atol=1e-12)


def test_ik_beyond_reach_straightens_the_leg_as_far_as_the_knee_allows():
    foot = kinematics.foot_pos_b(a1.STAND_JOINT_POS) - [0.0, 0.0, 1.0]
    solved, error = kinematics.leg_ik(foot)
    np.testing.assert_allclose(solved[2::3], a1.JOINT_UPPER[2::3])
    # knee at its stop: reach = sqrt(0.2^2 + 0.2^2 + 2 0.2^2 cos 0.9163) = 0.35880; asked 1.25
    np.testing.assert_allclose(error, 1.25 - 0.35880, atol=1e-4)


def test_ik_is_no_worse_than_a_search_where_the_limits_bind():
    rng = np.random.default_rng(3)
    foot = a1.HIP_OFFSET + rng.uniform(-0.4, 0.4, (40, 4, 3))
    _, error = kinematics.leg_ik(foot)
    candidates = kinematics.foot_pos_b(random_joints(20000, seed=4))
    gaps = np.linalg.norm(candidates[:, None] - foot[None], axis=-1).min(axis=0)
    # It keeps the plane of the nearest hip angle: never far from the best of 20,000 guesses.
    assert np.mean(error <= gaps + 1e-9) > 0.9
    assert np.max(error - gaps) < 0.05


def test_ik_follows_a_paw_continuously_past_the_height_of_its_hip():
    height = np.linspace(-0.25, 0.08, 400)
    foot = np.tile(kinematics.foot_pos_b(a1.STAND_JOINT_POS), (400, 1, 1))
    foot[:, 0, 0] += 0.24
    foot[:, 0, 2] = height
    solved, error = kinematics.leg_ik(foot)
    assert np.max(error) < 1e-9
    assert np.max(np.abs(np.diff(solved, axis=0))) < 0.05


def test_jacobian_is_the_derivative_of_fk():
    joint_pos = random_joints(50, seed=5)
    jacobian, h = kinematics.leg_jacobian(joint_pos), 1e-6
    for j in range(3):
        step = np.zeros(12)
        step[j::3] = h
        up, down = (kinematics.foot_pos_b(joint_pos + s * step) for s in (1.0, -1.0))
        np.testing.assert_allclose(jacobian[..., j], (up - down) / (2 * h), atol=1e-9)


def test_mirroring_the_joints_mirrors_the_feet():
    joint_pos = random_joints(20, seed=6).reshape(-1, 4, 3)
    mirrored = joint_pos[:, [1, 0, 3, 2]] * [-1.0, 1.0, 1.0]
    foot = kinematics.foot_pos_b(joint_pos.reshape(-1, 12))
    foot_mirrored = kinematics.foot_pos_b(mirrored.reshape(-1, 12))
    np.testing.assert_allclose(foot_mirrored[:, [1, 0, 3, 2]] * [1, -1, 1], foot, atol=1e-12)


def test_batches_and_single_poses_agree():
    joint_pos = random_joints(6, seed=7).reshape(2, 3, 12)
    quat = geometry.normalize(np.random.default_rng(8).normal(size=(2, 3, 4)))
    pos = np.random.default_rng(9).normal(size=(2, 3, 3))
    foot = kinematics.foot_pos_w(pos, quat, joint_pos)
    link_pos, link_quat = kinematics.link_frames_w(pos, quat, joint_pos)
    for i in np.ndindex(2, 3):
        np.testing.assert_allclose(
            kinematics.foot_pos_w(pos[i], quat[i], joint_pos[i]), foot[i], atol=1e-12
        )
        one_pos, one_quat = kinematics.link_frames_w(pos[i], quat[i], joint_pos[i])
        np.testing.assert_allclose(one_pos, link_pos[i], atol=1e-12)
        np.testing.assert_allclose(one_quat, link_quat[i], atol=1e-12)


@pytest.mark.parametrize("shape", [(11,), (3, 4)])
def test_wrong_shapes_are_refused(shape: tuple[int, ...]):
    with pytest.raises(AssertionError, match="12"):
        kinematics.foot_pos_b(np.zeros(shape))
