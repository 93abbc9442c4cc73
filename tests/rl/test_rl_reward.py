"""Every reward term against numbers worked out by hand."""

import numpy as np
import pytest

from studio.rl import reward
from studio.rl.reward import RewardConfig
from studio.robot import a1, kinematics


def test_pose_term_is_exp_of_minus_the_sum_over_joints() -> None:
    q, ref = np.zeros((1, 12)), np.zeros((1, 12))
    ref[0, 0], q[0, 5] = 0.3, -0.4  # 0.09 + 0.16 = 0.25
    assert reward.pose(q, ref, 1.0) == pytest.approx(np.exp(-0.25))


def test_foot_term_sums_over_feet_and_axes() -> None:
    x, ref = np.zeros((1, 4, 3)), np.zeros((1, 4, 3))
    x[0, 0] = [0.03, 0.0, 0.04]  # 0.0025 m²
    x[0, 3] = [0.0, 0.05, 0.0]  # 0.0025 m²
    assert reward.foot(x, ref, 20.0) == pytest.approx(np.exp(-20.0 * 0.005))


def test_root_terms_take_squared_distance_and_squared_angle() -> None:
    pos = np.array([[0.1, 0.0, 0.3]])
    assert reward.root_pos(pos, np.array([[0.0, 0.0, 0.3]]), 20.0) == pytest.approx(np.exp(-0.2))
    assert reward.root_ori(np.array([0.2]), 5.0) == pytest.approx(np.exp(-5.0 * 0.04))


def test_acceleration_term_differences_velocities_over_one_period() -> None:
    now, before = np.full((1, 12), 2.0), np.zeros((1, 12))
    # 12 joints, (2 rad/s / (1/30 s))² = 3600 each: 43200 · 1e-5 = 0.432
    assert reward.acc(now, before, 1.0 / 30.0, 1e-5) == pytest.approx(np.exp(-0.432))


def test_support_distance_is_zero_inside_and_grows_outside() -> None:
    feet = np.array([[0.2, -0.1], [0.2, 0.1], [-0.2, -0.1], [-0.2, 0.1]])
    vertices = np.repeat(feet[None], 4, axis=0)
    used = np.ones((4, 4), dtype=bool)
    used[3] = [True, False, True, True]  # the front left foot is lifted
    point = np.array([[0.0, 0.0], [0.25, 0.0], [0.25, 0.14], [0.1, 0.1]])
    # inside; 5 cm ahead; 5 and 4 cm off a corner; off the edge FR-RL, y = -x/2: (0.1+0.05)/√1.25
    expected = [0.0, 0.05, np.hypot(0.05, 0.04), 0.15 / np.hypot(1.0, 0.5)]
    assert reward.outside_support(point, vertices, used) == pytest.approx(np.array(expected))


def test_support_distance_counts_only_where_three_contacts_are_asked_for() -> None:
    vertices = np.array([[[0.2, -0.1], [0.2, 0.1], [-0.2, -0.1], [-0.2, 0.1]]])
    trot = np.array([[True, False, False, True]])
    assert reward.outside_support(np.array([[1.0, 1.0]]), vertices, trot) == 0.0


def test_the_centre_of_mass_comes_down_along_gravity_seen_from_the_heading() -> None:
    joints = a1.STAND_JOINT_POS[None]
    x, y, z = kinematics.center_of_mass_b(joints[0])
    assert x == pytest.approx(0.0, abs=0.02)  # and the trunk's origin is not where it is
    assert abs(x) > 1e-3
    # A trunk 0.3 m up, turned left by 90°: the centre lies at (−y, x) from it in the world, 0.3 + z
    # over the ground. Gravity leans by 1 in 10 towards +x of the world, so it comes down another
    # (0.3 + z) / 10 along x. In the robot's heading frame world (a, b) is (b, −a).
    quat = np.array([[np.sqrt(0.5), 0.0, 0.0, np.sqrt(0.5)]])
    gravity = np.array([[0.981, 0.0, -9.81]])
    yaw = np.array([np.pi / 2])
    point = reward.support_point(np.array([[5.0, -2.0, 0.3]]), quat, joints, gravity, yaw)
    assert point[0] == pytest.approx([x, y - (0.3 + z) / 10.0])
    # Pitched nose down by 90°, body z points forward: the centre comes down z ahead.
    quat = np.array([[np.sqrt(0.5), 0.0, np.sqrt(0.5), 0.0]])
    level = np.array([[0.0, 0.0, -1.0]])
    point = reward.support_point(np.array([[0.0, 0.0, 0.3]]), quat, joints, level, np.zeros(1))
    assert point[0] == pytest.approx([z, y])


def test_support_term_squares_the_distance() -> None:
    assert reward.support(np.array([0.1]), 10.0) == pytest.approx(np.exp(-0.1))


def test_total_multiplies_the_main_terms_and_adds_the_acceleration() -> None:
    names = ("pose", "foot", "root_pos", "root_ori", "support")
    terms = {n: np.array([v]) for n, v in zip(names, (0.9, 0.8, 0.7, 0.6, 0.5), strict=True)}
    terms["acc"] = np.array([0.4])
    # 0.9 · 0.1512 + 0.1 · 0.4
    assert reward.total(terms, RewardConfig()) == pytest.approx(0.9 * 0.1512 + 0.04)


def test_perfect_tracking_is_worth_one() -> None:
    one = np.ones(3)
    names = ("pose", "foot", "root_pos", "root_ori", "support", "acc")
    terms: dict[str, np.ndarray] = {name: one for name in names}
    assert reward.total(terms, RewardConfig()) == pytest.approx(one)
