"""Every figure against a value worked out by hand."""

import numpy as np
import pytest

from studio import geometry, metrics, statistics

LEVEL = np.tile([1.0, 0.0, 0.0, 0.0], (4, 1))


def test_joint_rmse_of_one_joint_off_by_twelve_degrees():
    reference = np.zeros((5, 12))
    joint_pos = reference.copy()
    joint_pos[:, 3] = np.radians(12.0)
    # sqrt(12^2 / 12) = sqrt(12)
    assert metrics.joint_rmse_deg(joint_pos, reference) == pytest.approx(np.sqrt(12.0))


def test_foot_error_ignores_where_the_robot_stands_and_where_it_heads():
    rng = np.random.default_rng(0)
    feet_b, pos = rng.normal(size=(4, 4, 3)), np.zeros((4, 3))
    turned = geometry.quat_from_rpy(np.tile([0.0, 0.0, 1.2], (4, 1)))
    moved = pos + [3.0, -1.0, 0.0]
    feet_moved = geometry.quat_rotate(turned[:, None], feet_b) + moved[:, None]
    error = metrics.foot_error_m(moved, turned, feet_moved, pos, LEVEL, feet_b)
    assert error == pytest.approx(0.0, abs=1e-12)


def test_foot_error_is_the_mean_distance_over_the_feet():
    feet = np.zeros((4, 4, 3))
    off = feet.copy()
    off[:, 0] = [0.03, 0.04, 0.0]  # 5 cm on one of four
    zero = np.zeros((4, 3))
    assert metrics.foot_error_m(zero, LEVEL, off, zero, LEVEL, feet) == pytest.approx(0.0125)


def test_orientation_error_is_tilt_without_heading():
    tilted = geometry.quat_from_rpy([0.3, 0.0, 0.0])
    yawed = geometry.quat_from_rpy([0.0, 0.0, 2.0])
    both = geometry.quat_mul(yawed, tilted)
    assert metrics.orientation_error(both, tilted) == pytest.approx(0.0, abs=1e-9)
    assert metrics.orientation_error(both, yawed) == pytest.approx(0.3)
    degrees = metrics.orientation_error_deg(np.stack([both, yawed]), np.stack([yawed, yawed]))
    assert degrees == pytest.approx(np.degrees(0.3) / 2)


def test_orientation_error_is_regular_where_the_trunk_points_up():
    up = geometry.quat_from_rpy([0.0, -np.pi / 2, 0.0])
    near = geometry.quat_from_rpy([0.0, -np.pi / 2 + 0.05, 0.0])
    assert metrics.orientation_error(near, up) == pytest.approx(0.05, abs=1e-9)


def test_contact_f1_counts_hits_misses_and_false_alarms():
    ours = np.array([[1, 1, 0, 0]])
    asked = np.array([[1, 0, 1, 0]])
    # one hit, one false alarm, one miss: 2 1 / (2 1 + 1 + 1) = 0.5
    assert metrics.contact_f1(ours, asked) == 0.5
    assert metrics.contact_f1(asked, asked) == 1.0
    assert metrics.contact_f1(np.zeros((2, 4)), np.zeros((2, 4))) == 1.0
    assert metrics.contact_f1(np.zeros((2, 4)), np.ones((2, 4))) == 0.0


def test_skate_is_the_horizontal_speed_of_feet_that_stay_down():
    foot = np.zeros((3, 4, 3))
    foot[1:, 0, 0] = 0.003  # one foot slips 3 mm in the first of two steps
    foot[:, 0, 2] = [0.0, 0.1, 0.0]  # height does not count
    contact = np.zeros((3, 4))
    contact[:, 0] = 1.0
    # (3 mm + 0) / 2 steps at 30 Hz = 0.045 m/s
    assert metrics.foot_skate_m_s(foot, contact, 1 / 30) == pytest.approx(0.045)
    contact[0, 0] = 0.0  # it lands in the second frame: the slip was in the air
    assert metrics.foot_skate_m_s(foot, contact, 1 / 30) == 0.0
    assert metrics.foot_skate_m_s(foot, np.zeros((3, 4)), 1 / 30) == 0.0


def test_limit_violations_count_periods_with_the_stated_tolerances():
    zero = np.zeros((6, 12))
    target, pos, vel, torque = zero.copy(), zero.copy(), zero.copy(), zero.copy()
    target[0, 0] = 1.001  # a target may not pass at all
    pos[1, 0] = 1.019  # within 0.02 rad
    pos[2, 0] = 1.021
    vel[3, 0] = -21.3  # over 21.21
    torque[4, 0] = 33.8  # within 1 %: 33.835
    torque[5, :] = -34.0  # twelve joints, one period
    count = metrics.limit_violations(
        target, pos, vel, torque,
        lower=-np.ones(12), upper=np.ones(12),
        speed_limit=np.full(12, 21.0), torque_limit=np.full(12, 33.5),
    )  # fmt: skip
    assert count == 4


def test_a_change_of_heading_counts_whole_turns_to_the_left():
    yaw = np.radians([10.0, 100.0, 190.0, 280.0, 370.0, 450.0])
    quats = geometry.quat_from_rpy(np.stack([0.0 * yaw, 0.0 * yaw, yaw], axis=-1))
    assert metrics.heading_change_deg(quats) == pytest.approx(440.0)
    assert metrics.heading_change_deg(quats[::-1]) == pytest.approx(-440.0)
    assert metrics.heading_change_deg(quats[:1]) == 0.0


def test_distance_is_the_path_over_the_ground_and_speed_its_rate():
    base = np.array([[0.0, 0, 0.3], [3.0, 4.0, 0.1], [0.0, 0.0, 0.3]])
    assert metrics.distance_m(base) == pytest.approx(10.0)  # there and back
    assert metrics.net_distance_m(base) == pytest.approx(0.0)
    assert metrics.net_distance_m(base[:2]) == pytest.approx(5.0)
    assert metrics.net_distance_m(base[:1]) == 0.0
    assert metrics.mean_speed_m_s(base, 0.5) == pytest.approx(10.0)  # in 2 periods of 0.5 s
    assert metrics.mean_speed_m_s(base[:1], 0.5) == 0.0


def test_joint_speed_is_the_fastest_joints_in_degrees_a_second():
    pos = np.zeros((3, 12))
    pos[1, 5] = np.radians(4.0)
    pos[1, 2] = np.radians(-3.0)
    pos[2] = pos[1]
    # 4 degrees in 1/30 s, then nothing
    assert metrics.joint_speed_deg_s(pos, 1 / 30) == pytest.approx([120.0, 0.0])
    assert metrics.joint_speed_deg_s(pos[:1], 1 / 30).shape == (0,)


def test_a_fall_is_a_trunk_on_the_ground_or_sixty_degrees_from_the_reference():
    tilt = geometry.quat_from_rpy(np.radians([[0.0, 59.0, 0.0], [0.0, 61.0, 0.0], [0.0, 0.0, 0.0]]))
    level = geometry.quat_from_rpy(np.zeros((3, 3)))
    touching = np.array([False, False, True])
    assert metrics.fallen(touching, tilt, level).tolist() == [False, True, True]
    sitting = geometry.quat_from_rpy(np.radians([0.0, -70.0, 0.0]))
    assert not metrics.fallen(False, sitting, sitting)


def test_success_is_time_to_the_first_fall():
    fallen = np.zeros(10, dtype=bool)
    assert metrics.success_time_ratio(fallen) == 1.0
    fallen[[4, 7]] = True
    assert metrics.success_time_ratio(fallen) == 0.4
    assert metrics.success_time_ratio(fallen[:5], periods=10) == 0.4  # it ended with the fall
    assert metrics.success_time_ratio(np.zeros(0, dtype=bool)) == 0.0


def test_tracked_needs_life_feet_and_tilt():
    fallen = np.array([False, False, False, False, True, False])
    foot = np.array([0.01, 0.09, 0.01, 0.01, 0.01, 0.01])
    tilt = np.radians([1.0, 1.0, 16.0, 14.0, 1.0, 1.0])
    # alive, foot < 8 cm and tilt < 15 deg: periods 0 and 3; after the fall nothing counts
    assert metrics.tracked_time_ratio(fallen, foot, tilt) == pytest.approx(2 / 6)
    assert metrics.tracked_time_ratio(fallen, foot, tilt, periods=12) == pytest.approx(2 / 12)


def test_robots_beside_each_other_have_the_figures_of_each_alone():
    rng = np.random.default_rng(3)
    fallen = rng.random((40, 5)) < 0.03
    foot, tilt = rng.uniform(0.0, 0.12, (40, 5)), rng.uniform(0.0, 0.4, (40, 5))
    success = metrics.success_time_ratio(fallen)
    tracked = metrics.tracked_time_ratio(fallen, foot, tilt)
    quat = geometry.normalize(rng.normal(size=(40, 5, 4)))
    other = geometry.normalize(rng.normal(size=(40, 5, 4)))
    lies = metrics.fallen(fallen, quat, other)
    for k in range(5):
        assert success[k] == metrics.success_time_ratio(fallen[:, k])
        assert tracked[k] == metrics.tracked_time_ratio(fallen[:, k], foot[:, k], tilt[:, k])
        assert all(lies[:, k] == metrics.fallen(fallen[:, k], quat[:, k], other[:, k]))
    # The fall is told by cosines, the error by an angle: they agree.
    over = np.degrees(metrics.orientation_error(quat, other)) > metrics.FALLEN_TILT_DEG
    assert np.array_equal(lies, fallen | over)


def test_bootstrap_interval_is_about_two_standard_errors_each_way():
    values = np.random.default_rng(1).normal(5.0, 2.0, 400)
    low, high = statistics.bootstrap_ci(values)
    standard_error = np.std(values) / 20.0
    assert low == pytest.approx(np.mean(values) - 1.96 * standard_error, abs=0.05)
    assert high == pytest.approx(np.mean(values) + 1.96 * standard_error, abs=0.05)
    assert statistics.bootstrap_ci(values) == (low, high)  # seeded
    assert statistics.bootstrap_ci([3.0]) == (3.0, 3.0)
    assert np.isnan(statistics.bootstrap_ci([])).all()


def test_a_lag_is_counted_in_whole_periods():
    t = np.arange(60.0)
    joints = np.stack([np.sin(0.3 * t), np.cos(0.2 * t)], axis=-1)
    assert [metrics.lag_periods(joints[10 - k : 50 - k], joints[10:50], 5) for k in (0, 3, 5)] == [
        0,
        3,
        5,
    ]
