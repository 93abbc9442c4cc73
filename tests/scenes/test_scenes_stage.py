"""A scene being played: success is read off the world, time and points off a clock, chance off a
seed."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.link.link import Order
from studio.reference.sitting import sit_poses
from studio.reference.stances import NEUTRAL
from studio.reference.standing import stand_poses
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose
from studio.scenes import greeting
from studio.scenes.checks import dodged, past, stands_near, tilted, touched_by_paw
from studio.scenes.scene import Seen
from studio.scenes.stage import PENALTY, WORTH, Stage
from studio.scenes.thrower import Thrower
from studio.sim.prop_world import PropWorld
from studio.sim.props import PropShape

STAND = a1.STAND_JOINT_POS


def standing(x: float = 0.0, **other) -> RobotPose:
    pose = NEUTRAL["stand"]
    return replace(pose, base_pos=pose.base_pos + [x, 0.0, 0.0], **other)


def begun(name: str, seed: int = 0, x: float = 0.0) -> Stage:
    stage = Stage(name, seed)
    stage.reset(standing(x))
    return stage


def seen(stage: Stage, **other) -> Seen:
    assert stage.seen is not None
    return replace(stage.seen, **other)


def thrown(joint_pos: np.ndarray, tries: int = 3) -> tuple[bool, int]:
    """Whether a robot that holds this pose dodges, and how often it is hit in so many throws."""
    stage = begun("greeting", seed=5)
    world = stage.world
    assert isinstance(world, PropWorld)
    throw = stage.scene.steps[2].throw
    assert throw is not None
    for _ in range(45):
        stage.step(Order(target=joint_pos))
    thrower, hits = Thrower(throw, world), 0
    for _ in range(round(tries * 5.5 / a1.CONTROL_DT)):
        stage.step(Order(target=joint_pos))
        hits += thrower.step(seen(stage))
    return thrower.dodged, hits


def test_a_ball_hits_who_stands_and_flies_over_who_crouches() -> None:
    crouch = stand_poses(np.zeros((1, 3)), np.ones(1), np.zeros((1, 2)), np.zeros((1, 2)))[2][0]
    dodges, hits = thrown(STAND)
    assert not dodges
    assert hits >= 2
    dodges, hits = thrown(crouch)
    assert dodges
    assert hits == 0


def test_the_high_target_is_out_of_reach_of_who_stands_and_in_reach_of_who_sits() -> None:
    low = greeting.HIGH.pos[2] - greeting.HIGH.size[1] - a1.FOOT_RADIUS
    tilts = np.zeros((63, 3))
    tilts[:, 1] = np.repeat(np.radians(np.linspace(-40.0, 20.0, 7)), 9)
    reach = np.zeros((63, 2))
    reach[:, 0] = np.tile(np.linspace(0.2, 1.0, 9), 7)
    zero = np.zeros((63, 2))
    stood = kinematics.foot_pos_w(*stand_poses(tilts, np.zeros(63), reach, zero))[:, 0, 2]
    sat = kinematics.foot_pos_w(*sit_poses(0.0 * tilts, reach, zero))[:, 0, 2]
    assert stood.max() < low - 0.15
    assert sat.max() > low


def test_a_greeting_is_a_lean_on_four_feet() -> None:
    stage = begun("greeting")
    for deg, yes in ((0.0, False), (11.0, False), (13.0, True), (70.0, False)):
        quat = geometry.quat_from_rpy([np.radians(deg), 0.0, 0.0])
        leaning = replace(stage.world.state, base_quat=quat, foot_contact=np.ones(4))
        assert tilted(12.0)(seen(stage, robot=leaning)) is yes
    three = replace(leaning, base_quat=geometry.quat_from_rpy([0.3, 0.0, 0.0]))
    three = replace(three, foot_contact=np.array([1.0, 1.0, 1.0, 0.0]))
    assert not tilted(12.0)(seen(stage, robot=three))


def test_standing_on_a_mark_and_passing_a_pole_are_read_off_the_trunk() -> None:
    stage = begun("slalom", x=3.0)
    assert stands_near(3.0, 0.3, 0.4)(seen(stage))
    assert not stands_near(3.0, 0.5, 0.4)(seen(stage))
    hasty = replace(stage.world.state, base_lin_vel_w=np.array([0.3, 0.0, 0.0]))
    assert not stands_near(3.0, 0.0, 0.4)(seen(stage, robot=hasty))
    assert past(2.9, (-0.1, 0.1))(seen(stage))
    assert not past(2.9, (0.1, 1.0))(seen(stage))
    assert not past(3.1, (-0.1, 0.1))(seen(stage))


def test_only_a_front_paw_counts_as_a_paw() -> None:
    stage = begun("greeting")
    check = touched_by_paw("target")
    assert check(seen(stage, touched=frozenset({("target", "FL_foot")})))
    for other in (("target", "FL_calf"), ("target", "RR_foot"), ("high", "FL_foot")):
        assert not check(seen(stage, touched=frozenset({other})))
    assert not dodged(seen(stage))


def test_a_touch_between_two_control_periods_is_seen_and_moves_what_hangs() -> None:
    ball = PropShape(name="ball", kind="ball", size=(0.04,), pos=(0.6, -0.0, 0.27), held="hung")
    stone = PropShape(
        name="stone", kind="ball", size=(0.03,), pos=(1.0, 0.5, 0.03), held="free", mass=0.1
    )
    world = PropWorld((ball, stone))
    world.step(STAND)
    assert world.touched == frozenset()
    # At 8 m/s it is at the robot's front and off again within one period of 33 ms.
    world.throw("stone", (0.42, 0.0, 0.27), (-8.0, 0.0, 0.0))
    names = set()
    for _ in range(3):
        world.step(STAND)
        names |= world.touched
    assert any(a == "stone" and b.startswith(("F", "trunk")) for a, b in names)
    assert not world.state.trunk_contact  # who is hit has not fallen
    world.throw("stone", (0.66, 0.0, 0.27), (-2.0, 0.0, 0.0))
    for _ in range(5):
        world.step(STAND)
    assert world.position("ball") == pytest.approx(ball.pos, abs=1e-3)  # it meets the robot alone


def test_props_are_where_chance_put_them_and_the_same_for_a_seed() -> None:
    places = [begun("push", seed).world.position("box") for seed in (1, 1, 2)]
    assert np.array_equal(places[0], places[1])
    assert not np.array_equal(places[0], places[2])
    spread = begun("push").scene.scatter["box"]
    nominal = np.array([1.5, 0.0, 0.2])
    assert all(np.all(np.abs(p - nominal) <= np.array(spread) + 1e-9) for p in places)
    poles = [begun("slalom", seed).world.position("pole2") for seed in (1, 2)]
    assert not np.array_equal(poles[0], poles[1])


def test_the_clock_runs_from_the_first_movement_and_a_step_may_be_late() -> None:
    stage = begun("push")
    for _ in range(30):
        stage.step(Order(target=STAND))
    assert stage.time == 0.0
    stage.world.push(np.array([0.0, 1.0, 0.0]))
    for _ in range(30):
        stage.step(Order(target=STAND))
    assert stage.time > 0.5
    late = round(stage.scene.steps[0].within / a1.CONTROL_DT)
    stage._step_t = late * a1.CONTROL_DT
    stage.step(Order(target=STAND))
    assert stage.progress()["failed"] == "out of time"
    time = stage.time
    stage.step(Order(target=STAND))
    assert stage.time == time


def test_a_step_done_is_worth_points_a_touch_costs_some_and_all_begins_anew() -> None:
    stage = begun("slalom")
    world = stage.world
    assert isinstance(world, PropWorld)
    pole = world.position("pole1")
    world.move_base(pole[:2] + [0.15, 0.4], 0.0)
    stage.step(Order(target=STAND))
    progress = stage.progress()
    assert (progress["step"], progress["finished"]) == (1, False)
    assert progress["steps"][0]["done"]
    assert progress["score"] == pytest.approx(WORTH, abs=1)
    world.move_base(pole[:2] + [0.0, 0.14], 0.0)  # into the pole
    for _ in range(5):
        stage.step(Order(target=STAND))
    assert stage.penalty == PENALTY  # one touch, however long
    assert stage.progress()["score"] == pytest.approx(WORTH - PENALTY, abs=1)
    stage.reset(standing())
    assert (stage.progress()["step"], stage.penalty, stage.time) == (0, 0.0, 0.0)


def test_a_robot_on_its_back_has_failed_its_scene() -> None:
    stage = begun("fetch")
    stage.reset(standing(base_quat=geometry.quat_from_rpy([np.pi, 0.0, 0.0])))
    for _ in range(20):
        stage.step(Order(target=STAND))
    assert stage.fallen(NEUTRAL["stand"])
    assert stage.progress()["failed"] == "the robot fell"
    stage.reset(standing())
    assert stage.progress()["failed"] is None


def test_rough_ground_is_ground_and_a_pole_is_none() -> None:
    rough = begun("rough")
    assert isinstance(rough.world, PropWorld)
    ground = [n for n, g in zip(rough.world._geom_name, rough.world._geom_ground) if g]
    assert {"floor", "step1", "slope", "bump0_0"} <= set(ground)
    poles = begun("slalom").world
    assert isinstance(poles, PropWorld)
    ground = [n for n, g in zip(poles._geom_name, poles._geom_ground) if g]
    assert "pole1" not in ground


def test_a_string_pulls_and_never_pushes() -> None:
    ball = PropShape(
        name="ball", kind="ball", size=(0.04,), pos=(0.0, 1.0, 0.5), held="hung", mass=0.1
    )
    world = PropWorld((ball,))
    for _ in range(30):
        world.step(STAND)
    assert world.position("ball") == pytest.approx(ball.pos, abs=2e-3)
    world.throw("ball", (0.0, 1.0, 0.6))  # lifted, it falls back and is caught
    world.step(STAND)
    assert world.position("ball")[2] == pytest.approx(0.6 - 0.5 * 9.81 / 900.0, abs=2e-3)
    top = ball.hook(ball.pos)
    for k in range(60):
        world.step(STAND)
        tie = world.position("ball") + [0.0, 0.0, 0.04]
        assert np.linalg.norm(tie - top) < ball.string + 0.02, k
    world.put("ball", (0.2, 1.0, 0.45))
    for _ in range(30):
        world.step(STAND)
    assert world.position("ball") == pytest.approx([0.2, 1.0, 0.45], abs=5e-3)
