"""Capsule clearances: segments by brute force, stances free, crossed legs caught."""

import numpy as np
from hypothesis import example, given, settings
from hypothesis import strategies as st

from studio.reference.stances import NEUTRAL
from studio.robot import a1, kinematics
from studio.robot.collision import CAPSULES, PAIRS, segment_distance

coordinates = st.lists(st.floats(-1.0, 1.0), min_size=12, max_size=12)


def brute_force(p1, q1, p2, q2) -> float:
    s = np.linspace(0.0, 1.0, 401)[:, None]
    a, b = p1 + s * (q1 - p1), p2 + s * (q2 - p2)
    return float(np.min(np.linalg.norm(a[:, None] - b[None], axis=-1)))


@settings(max_examples=60, deadline=None)
@given(coordinates)
@example([0.0, 0.0, 2.0**-24] + 9 * [0.0])
@example([0.0, 1.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 2.0**-24])
def test_segment_distance_is_the_smallest_of_all_pairs_of_points(values: list[float]):
    points = np.array(values).reshape(4, 3)
    found = float(segment_distance(*points))
    sampled = brute_force(*points)
    # Never more than any sampled pair, but for a segment so short that it counts as a point ...
    assert found <= sampled + 1e-6
    assert found >= sampled - 0.01  # ... nor less than the grid could miss


def test_segment_distance_of_points_parallels_and_crossings():
    x = np.array
    zero, one = x([0.0, 0, 0]), x([1.0, 0, 0])
    assert segment_distance(zero, zero, x([0, 3.0, 4]), x([0, 3.0, 4])) == 5.0  # 3-4-5
    assert segment_distance(zero, one, x([0, 2.0, 0]), x([1, 2.0, 0])) == 2.0
    assert segment_distance(zero, one, x([0.5, -1, 0]), x([0.5, 1, 0])) == 0.0
    assert segment_distance(zero, one, x([3.0, 0, 0]), x([4.0, 0, 0])) == 2.0


def test_neutral_stances_are_free_of_collision_and_crossed_feet_are_not():
    assert kinematics.self_collision_distance(a1.STAND_JOINT_POS) > 0.02
    assert kinematics.self_collision_distance(NEUTRAL["sit"].joint_pos) > 0.02
    foot = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    foot[0, 1] = foot[1, 1] = 0.0  # both front feet on one spot
    crossed, error = kinematics.leg_ik(foot)
    assert np.max(error) < 1e-9
    assert kinematics.self_collision_distance(crossed) < 0.0


def test_one_leg_alone_never_touches_itself_so_its_links_need_no_check():
    rng = np.random.default_rng(0)
    joint_pos = rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (20000, 12))
    start, end, radius = kinematics.link_capsules(joint_pos)
    names = [c.name for c in CAPSULES]
    hip = names.index("FR_hip")
    for part in ("FR_calf", "FR_foot"):
        i = names.index(part)
        gap = segment_distance(start[:, hip], end[:, hip], start[:, i], end[:, i])
        assert np.min(gap) > radius[hip] + radius[i]


def test_pairs_leave_out_neighbours_and_count_each_pair_once():
    assert len(set(PAIRS)) == len(PAIRS) == 114
    for i, j in PAIRS:
        assert CAPSULES[i].link[:2] != CAPSULES[j].link[:2]


def test_clearance_is_vectorised_over_the_batch():
    joint_pos = np.random.default_rng(1).uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (3, 2, 12))
    batch = kinematics.self_collision_distance(joint_pos)
    assert batch.shape == (3, 2)
    one = kinematics.self_collision_distance(joint_pos[2, 1])
    np.testing.assert_allclose(one, batch[2, 1], atol=1e-12)
