"""Stand, walk, sit and the ways between them: followed on paper and in the simulator."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest

from studio import geometry, metrics
from studio.control.drive_command import Directive
from studio.control.footing import facing, feet_w, placed, solve
from studio.control.interpolation import (
    MAX_JOINT_SPEED,
    least_seconds,
    trapezoid,
    trapezoid_time,
)
from studio.control.state_machine import StateMachine
from studio.control.transition import MAX_SECONDS, MIN_SECONDS, plan, settle
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.library import TASKS
from studio.reference.motion import with_velocity
from studio.reference.realize import realize
from studio.reference.stances import NEUTRAL, fit_plane
from studio.robot import a1
from studio.robot.pose import RobotPose
from studio.sim.actuation import LowPass, limit_target
from studio.sim.world import World

PAIRS = [("stand", "walk"), ("walk", "stand"), ("stand", "sit"), ("sit", "stand")]


def reference_of(state):
    return with_velocity(NEUTRAL[state], NEUTRAL[state])


def run(machine, wanted, seconds, directive=Directive.FOLLOW, reference=None):
    """Controls over `seconds` of a person who holds the neutral pose of `wanted`."""
    reference = reference or reference_of(wanted)
    return [machine.step(wanted, reference, directive) for _ in range(round(seconds * 30))]


def joint_speeds(controls):
    joints = np.array([c.reference.joint_pos for c in controls])
    return np.degrees(np.abs(np.diff(joints, axis=0)).max(axis=1) * 30.0)


def test_minimum_jerk_starts_and_ends_at_rest_and_is_halfway_at_half_time():
    assert minimum_jerk(0.0) == 0.0
    assert minimum_jerk(1.0) == 1.0
    assert minimum_jerk(0.5) == pytest.approx(0.5)  # 10/8 - 15/16 + 6/32
    assert (minimum_jerk(1e-3) / 1e-3) < 1e-5
    assert minimum_jerk(-1.0) == 0.0
    assert minimum_jerk(2.0) == 1.0


def test_the_time_of_a_trapezoid_is_its_inverse():
    shares = np.linspace(0.0, 1.0, 41)
    there = [trapezoid(s) for s in shares]
    np.testing.assert_allclose([trapezoid_time(u) for u in there], shares, atol=1e-12)
    assert np.max(np.diff(there) * 40) == pytest.approx(1.25)


@pytest.mark.parametrize(("source", "goal"), [("stand", "sit"), ("sit", "stand")])
def test_a_way_takes_what_its_fastest_joint_needs_however_it_is_timed(source, goal):
    for segment in plan(NEUTRAL[source], source, goal).segments:
        way = segment.way
        usual, hurried = least_seconds([way])[0]
        for seconds, progress in ((usual, minimum_jerk), (hurried, trapezoid)):
            u = np.array([progress(s) for s in np.linspace(0.0, 1.0, 400)])
            speed = np.abs(np.diff(way.motion(u)[2], axis=0)).max() * 399 / seconds
            assert speed == pytest.approx(MAX_JOINT_SPEED, rel=0.03)
        assert hurried < usual


def test_fitting_a_plane_finds_the_turn_and_the_move_that_were_made():
    points = np.array([[0.2, 0.1], [0.2, -0.1], [-0.2, 0.1], [-0.2, -0.1]])
    c, s = np.cos(0.4), np.sin(0.4)
    moved = points @ np.array([[c, -s], [s, c]]).T + [1.0, 2.0]
    position, yaw = fit_plane(points, moved)
    np.testing.assert_allclose(position, [1.0, 2.0])
    assert yaw == pytest.approx(0.4)


@pytest.mark.parametrize(("source", "goal"), PAIRS)
def test_a_way_begins_where_the_robot_is_and_ends_in_the_neutral_pose(source, goal):
    path = plan(NEUTRAL[source], source, goal)
    assert MIN_SECONDS <= path.seconds <= MAX_SECONDS
    np.testing.assert_allclose(path.at(0.0).joint_pos, NEUTRAL[source].joint_pos, atol=1e-6)
    end = path.at(path.seconds)
    np.testing.assert_allclose(end.joint_pos, NEUTRAL[goal].joint_pos, atol=1e-6)
    np.testing.assert_allclose(end.base_pos[2], NEUTRAL[goal].base_pos[2], atol=1e-6)
    assert float(geometry.quat_angle(end.base_quat, NEUTRAL[goal].base_quat)) < 1e-6


@pytest.mark.parametrize(("source", "goal"), PAIRS)
def test_joints_stay_within_limits_and_under_120_degrees_a_second_on_the_way(source, goal):
    path = plan(NEUTRAL[source], source, goal)
    poses = [path.at(t) for t in np.arange(0.0, path.seconds + 0.1, 1 / 30)]
    joints = np.array([p.joint_pos for p in poses])
    assert np.degrees(np.abs(np.diff(joints, axis=0)).max() * 30.0) <= 120.0
    assert (joints >= a1.JOINT_LOWER - 1e-9).all()
    assert (joints <= a1.JOINT_UPPER + 1e-9).all()


@pytest.mark.parametrize("reach", [(1.0, 0.0), (0.0, 1.0), (0.5, 0.0)])
@pytest.mark.parametrize("goal", ["sit", "walk"])
def test_a_raised_paw_comes_down_first_within_the_speed_limit(reach, goal):
    track = TASKS["manipulate_right"].sample(np.random.default_rng(0), 2.0)
    held = replace(track, reach=np.tile(reach, (len(track), 1)), reach_side=0.0 * track.reach_side)
    start = realize(held).poses()[-1]
    assert feet_w(start)[:2, 2].max() > 0.1
    path = plan(start, "stand", goal)
    assert path.seconds <= MAX_SECONDS + 0.6
    poses = [path.at(t) for t in np.arange(0.0, path.seconds + 0.1, 1 / 30)]
    joints = np.array([p.joint_pos for p in poses])
    assert np.degrees(np.abs(np.diff(joints, axis=0)).max() * 30.0) <= 120.0
    assert min(feet_w(p)[:, 2].min() for p in poses) > a1.FOOT_RADIUS - 2e-3


@pytest.mark.parametrize(("source", "goal"), PAIRS)
def test_feet_that_carry_do_not_slide_on_the_way(source, goal):
    path = plan(NEUTRAL[source], source, goal)
    poses = [path.at(t) for t in np.arange(0.0, path.seconds, 1 / 30)]
    for a, b in pairwise(poses):
        planted = (a.foot_contact > 0.5) & (b.foot_contact > 0.5)
        moved = np.linalg.norm(feet_w(a) - feet_w(b), axis=1)[planted]
        assert (moved < 0.002).all()  # 6 cm/s at most, of the IK at the edge of its reach


def test_feet_far_from_home_step_there_diagonal_pair_by_pair_and_land_on_the_floor():
    feet = feet_w(NEUTRAL["stand"]) + [[0.05, 0, 0], [-0.05, 0, 0], [-0.05, 0, 0], [0.05, 0, 0]]
    joints = with_feet(feet)
    path = plan(joints, "walk", "stand")
    lifted = np.array(
        [
            feet_w(path.at(t))[:, 2] > a1.FOOT_RADIUS + 0.01
            for t in np.arange(0.0, path.seconds, 1 / 30)
        ]
    )
    assert lifted.any(axis=0).all()
    assert not (lifted[:, [1, 2]].any(axis=1) & lifted[:, [0, 3]].any(axis=1)).any()
    end = feet_w(path.at(path.seconds))
    np.testing.assert_allclose(end[:, 2], a1.FOOT_RADIUS, atol=1e-6)


def with_feet(feet, base_pos=NEUTRAL["stand"].base_pos, yaw=0.0):
    return solve(base_pos, geometry.quat_from_rpy([0.0, 0.0, yaw]), feet)


def test_the_reference_passes_through_once_eased_in():
    machine = StateMachine()
    tilted = reference_of("stand")
    tilted = with_velocity(plan(tilted, "stand", "sit").at(0.4), tilted)
    last = run(machine, "stand", 2.0, reference=tilted)[-1]
    assert last.state == "stand"
    np.testing.assert_allclose(last.reference.joint_pos, tilted.joint_pos, atol=1e-9)


def test_following_is_announced_so_that_the_persons_motion_can_go_on_from_the_robots():
    machine = StateMachine()
    assert not machine.following
    run(machine, "stand", 0.1)
    assert machine.following
    run(machine, "sit", 0.5)
    assert not machine.following
    run(machine, "sit", 3.0)
    assert machine.following
    machine.rejoin()
    assert not machine.following


def test_the_feet_tell_which_way_the_robot_faces_even_with_the_trunk_twisted():
    turned = placed(NEUTRAL["stand"], np.array([1.0, 2.0]), 0.3)
    twisted = with_feet(feet_w(turned), base_pos=turned.base_pos, yaw=0.7)
    assert facing(twisted, "stand") == pytest.approx(0.3, abs=1e-6)
    sat = placed(NEUTRAL["sit"], np.zeros(2), -0.4)
    assert facing(sat, "sit") == pytest.approx(-0.4)


def test_sitting_down_is_reported_as_a_transition_and_then_as_sitting():
    machine = StateMachine()
    states = [c.state for c in run(machine, "sit", 4.0)]
    assert states[0] == "transition"
    assert states[-1] == "sit"
    assert MIN_SECONDS <= states.count("transition") / 30.0 <= MAX_SECONDS


def test_walking_reaches_sitting_through_standing():
    machine = StateMachine()
    run(machine, "walk", 3.0)
    seen = []
    for decision in run(machine, "sit", 6.0):
        if not seen or seen[-1] != decision.state:
            seen.append(decision.state)
    assert seen == ["transition", "stand", "transition", "sit"]


def test_a_transition_ignores_the_person_and_acts_on_the_latest_vote_at_its_end():
    machine = StateMachine()
    run(machine, "sit", 0.5)
    flips = [c for k in range(60) for c in run(machine, ("stand", "walk")[k % 2], 1 / 30)]
    assert all(c.state == "transition" and c.transition_to == "sit" for c in flips[:40])
    later = run(machine, "stand", 4.0)
    assert later[-1].state == "stand"


@pytest.mark.parametrize("after", [0.3, 0.8, 1.4, 2.0])
def test_a_call_to_stand_turns_a_transition_round_at_once(after):
    machine = StateMachine()
    run(machine, "sit", after)
    controls = run(machine, "sit", 3.2, Directive.STAND)
    assert controls[0].transition_to == "stand"
    assert controls[-1].state == "stand"
    assert joint_speeds(controls).max() <= 120.0


def test_feet_in_the_air_reach_the_floor_within_150_ms_when_walking_is_called_off():
    machine = StateMachine()
    feet = feet_w(NEUTRAL["walk"])
    feet[[1, 2], 2] += 0.06
    swing = with_velocity(with_feet(feet), with_feet(feet))
    run(machine, "walk", 2.5)
    run(machine, "walk", 1.0, reference=swing)
    assert feet_w(machine.reference)[1, 2] > 0.07
    halting = run(machine, "walk", 0.15, Directive.REST)
    np.testing.assert_allclose(feet_w(halting[-1].reference)[:, 2], a1.FOOT_RADIUS, atol=2e-3)
    assert run(machine, "walk", 4.0, Directive.REST)[-1].state == "stand"  # nobody stands in a walk


def test_resting_returns_to_the_neutral_pose_of_the_state_it_is_in():
    machine = StateMachine()
    run(machine, "sit", 4.0)
    joint_pos = NEUTRAL["sit"].joint_pos.copy()
    joint_pos[[1, 4]] = -0.9
    paw_up = replace(reference_of("sit"), joint_pos=joint_pos)
    raised = run(machine, "sit", 2.0, reference=paw_up)[-1]
    assert raised.reference.joint_pos[1] == pytest.approx(-0.9)
    rested = run(machine, "sit", 3.0, Directive.REST)
    assert all(c.state == "sit" for c in rested)
    np.testing.assert_allclose(rested[-1].reference.joint_pos, NEUTRAL["sit"].joint_pos, atol=1e-6)


def test_settling_ends_in_the_neutral_pose_over_the_same_feet():
    path = settle(plan(NEUTRAL["stand"], "stand", "sit").at(0.4), "stand")
    np.testing.assert_allclose(
        path.at(path.seconds).joint_pos, NEUTRAL["stand"].joint_pos, atol=1e-6
    )


def simulate(script, seed=0):
    """Worst tilt error (deg) and whether it fell, PD playback of a script of (seconds, state)."""
    rng = np.random.default_rng(seed)
    machine, world, low_pass = StateMachine(), World(seed=seed), LowPass()
    start = NEUTRAL["stand"].joint_pos + rng.normal(0.0, 0.02, 12)
    robot = world.reset(
        RobotPose(
            base_pos=NEUTRAL["stand"].base_pos,
            base_quat=geometry.IDENTITY_QUAT,
            joint_pos=start,
            foot_contact=np.ones(4),
        )
    )
    low_pass.reset(start)
    target, worst, states = start, 0.0, []
    for seconds, wanted in script:
        for k in range(round(seconds * 30)):
            decision = machine.step(wanted, reference_of(wanted))
            if k == 0:
                world.push(np.append(rng.normal(0.0, 0.1, 2), 0.0))
            target = limit_target(low_pass.step(decision.reference.joint_pos), target)
            robot = world.step(target)
            quat, asked = robot.base_quat, decision.reference.base_quat
            if metrics.fallen(robot.trunk_contact, quat, asked):
                return True, worst, states
            states.append(decision.state)
    return False, worst, states


@pytest.mark.parametrize(
    "seed", [0, *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(1, 8))]
)
def test_the_simulated_robot_sits_down_stands_up_and_walks_on_without_falling(seed):
    script = [(0.5, "stand"), (4, "sit"), (4, "stand"), (2, "walk"), (5, "sit"), (5, "walk")]
    fallen, _, states = simulate(script, seed)
    assert not fallen
    assert {"stand", "walk", "sit", "transition"} <= set(states)
