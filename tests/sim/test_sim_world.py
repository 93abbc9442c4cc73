"""One simulated A1: it stands and sits, keeps its limits, and refuses nonsense."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.typing import NDArray

from studio import geometry
from studio.errors import StudioError
from studio.reference.stances import NEUTRAL
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose, RobotState
from studio.sim import randomize
from studio.sim.actuation import LowPass, limit_target
from studio.sim.batch import BatchConfig, BatchWorld
from studio.sim.spec import ModelConfig
from studio.sim.world import World, WorldConfig

SECOND = 30


@pytest.fixture(scope="module")
def world() -> World:
    return World()


def run(world: World, target: np.ndarray, seconds: float) -> list[RobotState]:
    return [world.step(target) for _ in range(round(seconds * SECOND))]


def test_stands_five_seconds_within_two_centimetres(world: World):
    start = world.reset()
    states = run(world, a1.STAND_JOINT_POS, 5.0)
    base = np.array([s.base_pos for s in states])
    assert np.max(np.abs(base[:, 2] - start.base_pos[2])) < 0.02
    assert np.max(np.linalg.norm(base[SECOND:, :2] - start.base_pos[:2], axis=-1)) < 0.02
    assert np.all(states[-1].foot_contact == 1.0)
    assert not any(s.trunk_contact or s.self_collision for s in states)
    assert np.linalg.norm(states[-1].base_lin_vel_w) < 0.01
    assert states[-1].t == pytest.approx(5.0)


def test_sits_five_seconds_on_rear_legs_alone(world: World):
    pose = NEUTRAL["sit"]
    start = world.reset(pose)
    states = run(world, pose.joint_pos, 5.0)
    last = states[-1]
    assert geometry.quat_angle(last.base_quat, start.base_quat) < np.radians(10.0)
    assert not any(s.trunk_contact for s in states)
    assert last.foot_contact.tolist() == [0.0, 0.0, 1.0, 1.0]
    assert np.linalg.norm(last.base_lin_vel_w) < 0.01
    assert np.max([np.abs(s.torque) for s in states[SECOND:]]) < 12.0


@pytest.mark.parametrize(("filtered", "give"), [(True, 0.04), (False, 0.06)])
def test_torque_and_stops_hold_under_violent_targets(world: World, filtered: bool, give: float):
    """Random targets over the whole range, thirty a second: the robot falls and thrashes; its
    stops, springs as stiff as the physics step allows, give a little under its own weight."""
    start = world.reset()
    rng, low_pass = np.random.default_rng(0), LowPass()
    low_pass.reset(start.joint_pos)
    for _ in range(5 * SECOND):
        target = rng.uniform(a1.JOINT_LOWER - 1.0, a1.JOINT_UPPER + 1.0)
        state = world.step(limit_target(low_pass.step(target)) if filtered else target)
        assert np.all(np.abs(state.torque) <= a1.TORQUE_LIMIT * 1.01)
        assert np.all(state.joint_pos > a1.JOINT_LOWER - give)
        assert np.all(state.joint_pos < a1.JOINT_UPPER + give)
        assert np.all(np.abs(state.joint_vel) < 1.3 * a1.SPEED_LIMIT)


def test_motors_lose_their_torque_at_the_speed_limit(world: World):
    """In the air, full swings back and forth: no joint outruns 21 rad/s by more than 1 %."""
    world.reset()
    world.data.qpos[2] = 50.0
    fastest = 0.0
    for i in range(SECOND):
        world.step(a1.JOINT_UPPER if i // 5 % 2 else a1.JOINT_LOWER)
        fastest = max(fastest, float(np.max(np.abs(world.data.qvel[6:18]))))
    assert 15.0 < fastest < 21.0 * 1.01


def test_a_push_adds_its_velocity_and_is_survived(world: World):
    world.reset()
    run(world, a1.STAND_JOINT_POS, 1.0)
    before = world.data.qvel[:3].copy()
    world.push(np.array([0.0, 0.5, 0.0]))
    np.testing.assert_allclose(world.data.qvel[:3] - before, [0.0, 0.5, 0.0])
    state = run(world, a1.STAND_JOINT_POS, 3.0)[-1]
    assert geometry.quat_to_rpy(state.base_quat)[:2] == pytest.approx([0.0, 0.0], abs=0.1)


def test_damping_mode_lets_the_robot_sink_softly_and_ends_with_a_reset(world: World):
    world.reset()
    world.set_damping(True)
    states = run(world, a1.STAND_JOINT_POS, 4.0)
    assert states[-1].base_pos[2] < 0.15
    heights = np.array([s.base_pos[2] for s in states])
    assert np.min(np.diff(heights)) * SECOND > -1.0  # m/s: not a free fall's crash
    assert world.reset().base_pos[2] == pytest.approx(a1.STAND_HEIGHT, abs=1e-6)
    assert run(world, a1.STAND_JOINT_POS, 1.0)[-1].base_pos[2] > 0.25


def test_reset_places_the_lowest_point_of_any_pose_on_the_floor(world: World):
    rng = np.random.default_rng(1)
    for _ in range(20):
        pose = RobotPose(
            base_pos=rng.normal(size=3),
            base_quat=geometry.normalize(rng.normal(size=4)),
            joint_pos=rng.uniform(a1.JOINT_LOWER, a1.JOINT_UPPER),
            foot_contact=np.ones(4),
        )
        state = world.reset(pose)
        low = kinematics.lowest_point(state.base_pos, state.base_quat, state.joint_pos)
        assert low == pytest.approx(0.0, abs=1e-9)
        np.testing.assert_allclose(state.base_pos[:2], pose.base_pos[:2])
        assert geometry.quat_angle(state.base_quat, pose.base_quat) < 1e-9


def test_state_agrees_with_closed_form_kinematics_and_the_imu(world: World):
    world.reset()
    state = run(world, a1.STAND_JOINT_POS + 0.1, 0.5)[-1]
    foot = kinematics.foot_pos_w(state.base_pos, state.base_quat, state.joint_pos)
    np.testing.assert_allclose(state.foot_pos_w, foot)
    acceleration = world.data.sensor("imu_acc").data
    run(world, a1.STAND_JOINT_POS, 2.0)
    assert np.linalg.norm(acceleration) == pytest.approx(9.81, rel=0.05)
    touch = sum(float(world.data.sensor(f"{leg}_touch").data[0]) for leg in a1.LEGS)
    assert touch == pytest.approx(a1.TOTAL_MASS * 9.81, rel=0.05)


def test_a_trunk_on_its_back_and_crossed_legs_are_told(world: World):
    upside_down = RobotPose(
        base_pos=np.zeros(3),
        base_quat=geometry.quat_from_rpy([np.pi, 0.0, 0.0]),
        joint_pos=a1.STAND_JOINT_POS,
        foot_contact=np.zeros(4),
    )
    world.reset(upside_down)
    assert run(world, a1.STAND_JOINT_POS, 1.0)[-1].trunk_contact
    foot = kinematics.foot_pos_b(a1.STAND_JOINT_POS)
    foot[:2, 1] *= -0.2
    crossed, _ = kinematics.leg_ik(foot)
    world.reset()
    assert any(s.self_collision for s in run(world, crossed, 1.0))


@pytest.mark.parametrize(
    "target", [np.full(12, np.nan), np.full(12, np.inf), np.zeros(11), np.zeros((1, 12))]
)
def test_targets_that_are_not_twelve_finite_numbers_change_nothing(
    world: World, target: np.ndarray
):
    world.reset()
    before = world.data.qpos.copy()
    with pytest.raises(StudioError, match="12 finite"):
        world.step(target)
    np.testing.assert_array_equal(world.data.qpos, before)
    assert np.isfinite(world.step(a1.STAND_JOINT_POS).base_pos).all()


def test_poses_and_pushes_that_are_not_finite_are_refused(world: World):
    bad = RobotPose(
        base_pos=np.zeros(3),
        base_quat=np.zeros(4),
        joint_pos=a1.STAND_JOINT_POS,
        foot_contact=np.ones(4),
    )
    with pytest.raises(StudioError, match="finite"):
        world.reset(bad)
    with pytest.raises(StudioError, match="push"):
        world.push([np.nan, 0.0, 0.0])


def test_a_timestep_that_does_not_divide_the_control_period_is_refused():
    with pytest.raises(StudioError, match="1/240"):
        World(WorldConfig(model=ModelConfig(timestep=0.004)))


def test_the_same_targets_give_the_same_motion():
    def path() -> np.ndarray:
        world, rng = World(), np.random.default_rng(3)
        return np.array(
            [world.step(a1.STAND_JOINT_POS + 0.2 * rng.normal(size=12)).base_pos for _ in range(60)]
        )

    np.testing.assert_array_equal(path(), path())


def drawn(**changes) -> randomize.Dynamics:
    """One nominal robot on level ground, but for what is changed."""
    world = World()
    links = int(np.count_nonzero(world.model.body_mass > 0.0))
    nominal = {
        "mass": np.ones((1, links)),
        "friction": np.ones(1),
        "kp": np.ones(1),
        "kd": np.ones(1),
        "delay": np.zeros(1),
        "slope_axis": np.zeros((1, 2)),
    }
    return randomize.Dynamics(**{**nominal, **changes}, period=0.0)


def moved(world: World, periods: int = 12) -> NDArray:
    """Joints over time after a step of the targets."""
    target = a1.STAND_JOINT_POS + np.tile([0.0, 0.1, -0.15], 4)
    return np.array([world.step(target).joint_pos for _ in range(periods)])


def test_a_nominal_draw_changes_nothing():
    plain, same = World(), World()
    same.set_dynamics(drawn())
    same.reset()
    np.testing.assert_array_equal(moved(plain), moved(same))


@pytest.mark.parametrize(
    "motors",
    [
        {},
        {"armature": np.array([0.02]), "damping": np.array([0.4]), "strength": np.array([0.8])},
        {"strength": np.array([0.2])},  # too weak to do what is asked
    ],
)
def test_drawn_dynamics_are_those_of_the_batch(motors: dict):
    some = drawn(
        **motors,
        mass=np.linspace(0.8, 1.2, 13)[None],
        friction=np.array([0.7]),
        kp=np.array([0.8]),
        kd=np.array([1.2]),
        delay=np.array([0.012]),
    )
    world = World()
    world.set_dynamics(some)
    world.reset()
    batch = BatchWorld(BatchConfig(num_envs=1, threads=1, self_collision=True, leg_contact=True))
    batch.set_dynamics(np.arange(1), some)
    qpos = np.concatenate([world.state.base_pos, world.state.base_quat, world.state.joint_pos])
    batch.reset(np.arange(1), qpos[None], np.zeros((1, 18)))
    target = a1.STAND_JOINT_POS + np.tile([0.0, 0.1, -0.15], 4)
    for _ in range(12):
        one = world.step(target)
        batch.step(target[None])
        np.testing.assert_allclose(one.joint_pos, batch.joint_pos[0], atol=2e-3)
    plain = moved(World())[-1]
    assert np.abs(one.joint_pos - plain).max() > 5e-3
    if motors:
        nominal = World()
        nominal.set_dynamics(replace(some, armature=None, damping=None, strength=None))
        nominal.reset()
        assert np.abs(one.joint_pos - moved(nominal)[-1]).max() > 1e-3


def test_on_a_slope_the_robot_stands_tilted_wherever_it_is_put():
    world = World()
    world.set_dynamics(drawn(slope_axis=np.array([[0.0, 0.1]])))
    pose = RobotPose(
        base_pos=np.array([4.0, 1.0, 0.0]),
        base_quat=geometry.IDENTITY_QUAT,
        joint_pos=a1.STAND_JOINT_POS,
        foot_contact=np.ones(4),
    )
    world.reset(pose)
    for _ in range(45):
        robot = world.step(a1.STAND_JOINT_POS)
    assert robot.foot_contact.sum() == 4
    assert geometry.quat_to_rpy(robot.base_quat)[1] == pytest.approx(0.1, abs=0.02)
    assert robot.base_pos[2] == pytest.approx(0.27 - 4.0 * np.tan(0.1), abs=0.06)


def test_a_robot_carried_elsewhere_goes_on_as_it_would_have(world: World):
    """Standing on a level floor is alike at any place and heading: exact but for rounding."""
    other = World()
    for each in (world, other):
        each.reset()
        run(each, a1.STAND_JOINT_POS, 0.5)
        each.push([0.3, 0.1, 0.0])
        each.step(a1.STAND_JOINT_POS)
    before = world.state
    after = other.move_base([3.0, -2.0], 1.5)
    np.testing.assert_allclose(after.base_pos, [3.0, -2.0, before.base_pos[2]], atol=1e-12)
    assert geometry.heading(after.base_quat) == pytest.approx(1.5)
    turn = geometry.quat_mul(after.base_quat, geometry.quat_conj(before.base_quat))
    stayed, carried = (run(each, a1.STAND_JOINT_POS, 0.5)[-1] for each in (world, other))
    moved = geometry.quat_rotate(turn, stayed.base_pos - before.base_pos)
    np.testing.assert_allclose(carried.base_pos - after.base_pos, moved, atol=1e-6)
    np.testing.assert_allclose(carried.joint_pos, stayed.joint_pos, atol=1e-6)
    np.testing.assert_allclose(carried.base_ang_vel_b, stayed.base_ang_vel_b, atol=1e-5)
