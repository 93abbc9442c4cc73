"""Footholds: contact before temporal consistency, the root on its feet, turns only in walking."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.reference.stances import JOINT_SPEED, NEUTRAL, quickness, tilted
from studio.reference.tasks_walk import MAX_TURN
from studio.retarget.experts import EXPERTS
from studio.retarget.foothold_planner import FootholdPlanner
from studio.retarget.mapper import NUM_RATES, RATES, Mapped
from studio.retarget.settings import (
    LEVEL,
    STEEP,
    RetargetSettings,
    cap_stride,
    on_slope,
    shape_tilt,
)
from studio.robot import a1, kinematics

DT = a1.CONTROL_DT
QUICK = float(np.radians(300.0))


def resting(state: str, **changes: np.ndarray) -> Mapped:
    """What an expert says of somebody at rest, with some fields changed."""
    pose = NEUTRAL[state]  # type: ignore[index]
    mapped = Mapped(
        joint_pos=pose.joint_pos,
        base_quat=pose.base_quat,
        rates=np.zeros(NUM_RATES),
        contact_prob=pose.foot_contact,
    )
    return replace(mapped, **changes)


@pytest.mark.parametrize("state", list(EXPERTS))
def test_at_rest_every_state_stays_in_its_neutral_pose(state: str):
    planner = FootholdPlanner()
    planner.start(state)  # type: ignore[arg-type]
    for _ in range(60):
        pose, clipped = planner.step(resting(state), DT)
    np.testing.assert_allclose(pose.base_pos, NEUTRAL[state].base_pos, atol=1e-3)  # type: ignore[index]
    np.testing.assert_allclose(pose.joint_pos, NEUTRAL[state].joint_pos, atol=1e-2)  # type: ignore[index]
    assert not clipped
    assert planner.slips == 0


@pytest.mark.parametrize("slope", [0.0, 0.1])
@pytest.mark.parametrize("state", list(EXPERTS))
def test_no_joint_is_faster_than_allowed_on_its_floor_whatever_the_network_says(
    state: str, slope: float
):
    rng = np.random.default_rng(0)
    planner = FootholdPlanner(RetargetSettings(joint_speed=QUICK))
    planner.start(state)  # type: ignore[arg-type]
    planner.slope = np.array([0.6 * slope, -0.8 * slope])
    limit = EXPERTS[state].speed_limit  # type: ignore[index]
    if slope == 0.0:
        limit *= quickness(state, QUICK)  # type: ignore[arg-type]
    fastest = 0.0
    last = planner.last.joint_pos
    cut = 0
    for _ in range(60):
        wild = resting(
            state,
            joint_pos=rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER),
            base_quat=geometry.normalize(rng.normal(size=4)),
            contact_prob=rng.random(4),
        )
        pose, clipped = planner.step(wild, DT)
        speed = np.abs(pose.joint_pos - last).max() / DT
        fastest = max(fastest, speed)
        assert np.all(pose.joint_pos >= a1.JOINT_LOWER - 1e-9)
        assert np.all(pose.joint_pos <= a1.JOINT_UPPER + 1e-9)
        last = pose.joint_pos
        cut += clipped
    assert cut > 30
    assert 0.99 * limit < fastest <= limit + 1e-9


def test_the_steeper_the_floor_the_slower_a_quick_reference_and_a_slow_one_stays():
    paper = JOINT_SPEED["stand"]
    speeds = [on_slope(QUICK, np.array([0.0, -rise])) for rise in (0.0, LEVEL, 0.055, STEEP, 0.2)]
    assert speeds == pytest.approx([QUICK, QUICK, 0.5 * (QUICK + paper), paper, paper])
    assert on_slope(0.5 * paper, np.array([0.1, 0.1])) == 0.5 * paper


def test_a_tilt_leaves_the_standing_feet_where_they_are():
    planner = FootholdPlanner()
    before = kinematics.foot_pos_w(
        planner.last.base_pos, planner.last.base_quat, planner.last.joint_pos
    )
    quat = tilted("stand", np.radians([8.0, 10.0, 12.0]))
    for _ in range(60):
        pose, _ = planner.step(resting("stand", base_quat=quat), DT)
    feet = kinematics.foot_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos)
    np.testing.assert_allclose(feet, before, atol=1e-3)
    assert np.degrees(geometry.quat_angle(pose.base_quat, quat)) < 0.1


def test_only_walking_turns_and_slow_turns_are_nobodys_wish():
    for state, rate, turned in (("stand", 0.2, False), ("walk", 0.2, True), ("walk", 0.05, False)):
        planner = FootholdPlanner()
        planner.start(state)  # type: ignore[arg-type]
        rates = np.zeros(NUM_RATES)
        rates[RATES["base_ang_vel"]] = [0.0, 0.0, rate]
        air = np.zeros(4)  # nothing stands, so that nothing holds the heading back
        for _ in range(90):
            pose, _ = planner.step(resting(state, rates=rates, contact_prob=air), DT)
        assert (geometry.heading(pose.base_quat) > 0.1) == turned


def test_turning_is_never_faster_than_the_library_turns():
    planner = FootholdPlanner()
    planner.start("walk")
    rates = np.zeros(NUM_RATES)
    rates[RATES["base_ang_vel"]] = [0.0, 0.0, 3.0]
    for _ in range(90):
        pose, _ = planner.step(resting("walk", rates=rates, contact_prob=np.zeros(4)), DT)
    assert geometry.heading(pose.base_quat) <= 3.0 * MAX_TURN + 1e-6


def test_going_on_from_elsewhere_keeps_place_and_heading():
    planner = FootholdPlanner()
    there = replace(
        NEUTRAL["stand"],
        base_pos=np.array([1.0, -2.0, a1.STAND_HEIGHT]),
        base_quat=geometry.quat_from_rpy([0.0, 0.0, 0.7]),
    )
    planner.continue_from(there, 0.7)
    for _ in range(30):
        pose, clipped = planner.step(resting("stand"), DT)
    np.testing.assert_allclose(pose.base_pos, there.base_pos, atol=1e-3)
    np.testing.assert_allclose(geometry.heading(pose.base_quat), 0.7, atol=1e-6)
    assert not clipped


def test_gain_scales_a_tilt_and_the_dead_zone_swallows_a_small_one():
    neutral = NEUTRAL["sit"].base_quat
    small, large = (tilted("sit", np.radians([0.0, deg, 0.0])) for deg in (2.0, 10.0))
    gained = shape_tilt(large, neutral, RetargetSettings(tilt_gain=1.5))
    # 10 degrees times 1.5; with a dead zone of 3 degrees 10 becomes 7 and 2 becomes nothing.
    np.testing.assert_allclose(np.degrees(geometry.quat_angle(gained, neutral)), 15.0, atol=1e-6)
    quiet = RetargetSettings(dead_zone=np.radians(3.0))
    angles = [geometry.quat_angle(shape_tilt(q, neutral, quiet), neutral) for q in (small, large)]
    np.testing.assert_allclose(np.degrees(angles), [0.0, 7.0], atol=1e-6)


def test_the_speed_cap_shortens_strides_in_proportion():
    feet = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    feet[:, 0] += [0.08, -0.08, -0.08, 0.08]
    stride = kinematics.leg_ik(feet)[0]
    capped = kinematics.foot_pos_b(cap_stride(stride, 0.8, RetargetSettings(speed_cap=0.4)))
    home = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    np.testing.assert_allclose(capped[:, 0] - home[:, 0], [0.04, -0.04, -0.04, 0.04], atol=1e-3)
    np.testing.assert_array_equal(cap_stride(stride, 0.3, RetargetSettings(speed_cap=0.4)), stride)
