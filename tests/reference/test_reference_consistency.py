"""Contact locks, the root they carry, and the speed clip."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from studio import geometry
from studio.reference.consistency import limit_speed, limit_turn, make_consistent
from studio.reference.contact_lock import ContactConfig, ContactLock
from studio.reference.motion import ReferenceMotion
from studio.robot import a1, kinematics

DT = a1.CONTROL_DT
LEVEL = np.array([1.0, 0.0, 0.0, 0.0])
ALL = np.ones(4)


def standing_lock() -> ContactLock:
    lock = ContactLock()
    for _ in range(10):
        lock.step(a1.STAND_JOINT_POS, LEVEL, ALL, DT)
    return lock


def test_standing_still_stays_exactly_where_it_is():
    lock = standing_lock()
    joints = lock.step(a1.STAND_JOINT_POS, LEVEL, ALL, DT)
    np.testing.assert_allclose(joints, a1.STAND_JOINT_POS, atol=1e-4)
    np.testing.assert_allclose(lock.base_pos, [0.0, 0.0, a1.STAND_HEIGHT], atol=1e-4)


@settings(deadline=None)  # shared machines are slow at times
@given(st.integers(0, 1000))
def test_locked_feet_stay_put_whatever_the_mapper_says(seed: int):
    rng = np.random.default_rng(seed)
    lock = standing_lock()
    anchors = lock.anchor_w.copy()
    for _ in range(10):
        noisy = a1.STAND_JOINT_POS + rng.normal(scale=0.05, size=12)
        quat = geometry.quat_from_rpy(rng.normal(scale=0.1, size=3))
        joints = lock.step(noisy, quat, ALL, DT)
        feet = kinematics.foot_pos_w(lock.base_pos, quat, joints)
        np.testing.assert_allclose(feet, anchors, atol=1e-3)
    assert lock.slips == 0


def test_hysteresis_locks_above_half_and_releases_below_four_tenths():
    lock = ContactLock()
    for p, locked in ((0.49, False), (0.51, True), (0.45, True), (0.41, True), (0.39, False)):
        lock.step(a1.STAND_JOINT_POS, LEVEL, np.full(4, p), DT)
        assert lock.locked.all() == locked
    lock.step(a1.STAND_JOINT_POS, LEVEL, np.full(4, 0.45), DT)
    assert not lock.locked.any()


def test_a_released_foot_blends_back_within_100_ms():
    lock = standing_lock()
    lifted = a1.STAND_JOINT_POS.copy()
    lifted[1] += 0.3
    held = lock.step(lifted, LEVEL, ALL, DT)
    target = kinematics.foot_pos_b(lifted)[0]
    free = np.array([0.0, 1.0, 1.0, 1.0])
    gaps = [np.linalg.norm(kinematics.foot_pos_b(held)[0] - target)]
    for _ in range(6):
        joints = lock.step(lifted, LEVEL, free, DT)
        gaps.append(np.linalg.norm(kinematics.foot_pos_b(joints)[0] - target))
    assert gaps[1] > 0.5 * gaps[0]  # no jump in the frame of release
    assert gaps[4] < 0.1 * gaps[0]  # a tenth of a second later it is where it was asked to be


def test_feet_that_sweep_back_carry_the_root_forward():
    lock = standing_lock()
    home = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    for i in range(1, 11):
        swept = home.copy()
        swept[:, 0] -= 0.01 * i
        lock.step(kinematics.leg_ik(swept)[0], LEVEL, ALL, DT)
    np.testing.assert_allclose(lock.base_pos[0], 0.10, atol=1e-3)


def test_no_foot_goes_through_the_floor():
    lock = standing_lock()
    low = a1.STAND_JOINT_POS.copy()
    low[1:3] = [0.5, -1.0]  # a straighter front right leg: through the floor
    joints = lock.step(low, LEVEL, np.array([0.0, 1.0, 1.0, 1.0]), DT)
    feet = kinematics.foot_pos_w(lock.base_pos, LEVEL, joints)
    assert feet[0, 2] >= a1.FOOT_RADIUS - 2e-3


def test_a_foot_out_of_reach_slips_and_is_counted():
    lock = standing_lock()
    lock.anchor_w[0] += [0.5, 0.0, 0.0]
    lock.step(a1.STAND_JOINT_POS, LEVEL, ALL, DT)
    assert lock.slips >= 1


@settings(deadline=None)  # shared machines are slow at times
@given(st.integers(0, 1000), st.floats(0.1, 20.0))
def test_clip_bound_holds(seed: int, limit: float):
    rng = np.random.default_rng(seed)
    last, asked = rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER, (2, 12))
    joints, clipped = limit_speed(asked, last, limit, DT)
    assert np.max(np.abs(joints - last)) <= limit * DT + 1e-12
    assert clipped == bool(np.max(np.abs(asked - last)) > limit * DT + 1e-9)


def test_turning_is_limited_along_the_shortest_way():
    asked = geometry.quat_from_rpy([0.5, 0.0, 0.0])
    quat, clipped = limit_turn(asked, LEVEL, 3.0, DT)
    assert clipped
    np.testing.assert_allclose(quat, geometry.quat_from_rpy([0.1, 0.0, 0.0]), atol=1e-9)
    assert not limit_turn(asked, asked, 3.0, DT)[1]


def test_a_noisy_reference_made_consistent_skates_less_and_keeps_its_speed_limit():
    rng = np.random.default_rng(0)
    n = 90
    noise = rng.normal(scale=np.deg2rad(3.0), size=(n, 12))
    motion = ReferenceMotion(
        state="stand",
        task="noisy",
        dt=DT,
        base_pos=np.tile([0.0, 0.0, a1.STAND_HEIGHT], (n, 1)),
        base_quat=np.tile(LEVEL, (n, 1)),
        joint_pos=a1.STAND_JOINT_POS + noise,
        foot_contact=np.ones((n, 4)),
    )
    limit = np.deg2rad(120.0)
    clean = make_consistent(motion, limit)

    def skate(m: ReferenceMotion) -> float:
        feet = kinematics.foot_pos_w(m.base_pos, m.base_quat, m.joint_pos)[10:]
        return float(np.linalg.norm(np.diff(feet[..., :2], axis=0), axis=-1).mean() / DT)

    assert skate(clean) < 0.15 * skate(motion)
    assert np.abs(clean.joint_vel).max() <= limit + 1e-9


def test_a_foot_that_lands_again_soon_after_it_let_go_lands_where_it_is():
    # Held 6 cm from where it was asked to be, let go for four frames, then standing again.
    lock = standing_lock()
    lifted = a1.STAND_JOINT_POS.copy()
    lifted[1] += 0.3
    lock.step(lifted, LEVEL, ALL, DT)
    for _ in range(4):
        flying = lock.step(lifted, LEVEL, np.array([0.0, 1.0, 1.0, 1.0]), DT)
    before = kinematics.foot_pos_w(lock.base_pos, LEVEL, flying)[0]
    landed = lock.step(lifted, LEVEL, ALL, DT)
    after = kinematics.foot_pos_w(lock.base_pos, LEVEL, landed)[0]
    assert np.linalg.norm(after - before) < 0.01


def test_a_foot_that_the_clip_keeps_from_landing_does_not_drag_the_root():
    lock = standing_lock()
    up = a1.STAND_JOINT_POS.copy()
    up[:3] = [0.0, -0.5, -1.5]  # front right paw held high
    last = a1.STAND_JOINT_POS
    three = np.array([0.0, 1.0, 1.0, 1.0])
    path = []
    for contact, asked in [(three, up)] * 30 + [(ALL, a1.STAND_JOINT_POS)] * 30:
        wanted = lock.step(asked, LEVEL, contact, DT)
        last, clipped = limit_speed(wanted, last, np.deg2rad(120.0), DT)
        if clipped:
            lock.recheck(last, LEVEL)
        path.append(lock.base_pos.copy())
    assert np.linalg.norm(np.diff(path, axis=0), axis=1).max() / DT < 0.05
    assert lock.locked.all()
    assert lock.slips == 0


def test_a_walking_foot_left_behind_steps_to_where_it_is_asked_to_be():
    lock = ContactLock(ContactConfig(regrip=0.05))
    for _ in range(10):
        lock.step(a1.STAND_JOINT_POS, LEVEL, ALL, DT)
    ahead = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    ahead[0, 0] += 0.10
    asked = kinematics.leg_ik(ahead)[0]
    heights = []
    for _ in range(20):
        joints = lock.step(asked, LEVEL, ALL, DT)
        heights.append(kinematics.foot_pos_w(lock.base_pos, LEVEL, joints)[0, 2])
    reached = kinematics.foot_pos_b(joints)[0]
    assert np.linalg.norm(reached[:2] - ahead[0, :2]) < 0.05
    assert max(heights) > a1.FOOT_RADIUS + 0.02
    assert lock.locked.all()
