"""Batched worlds: delay against its closed form, draws against Table I, one world against many."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.robot import a1
from studio.sim import randomize
from studio.sim.batch import BatchConfig, BatchWorld, delayed_controls
from studio.sim.motors import MotorModel

N = 4


def stand(n: int) -> tuple[np.ndarray, np.ndarray]:
    pose = np.r_[0.0, 0.0, a1.STAND_HEIGHT, 1.0, 0.0, 0.0, 0.0, a1.STAND_JOINT_POS]
    return np.tile(pose, (n, 1)), np.zeros((n, 18))


def make(n: int = N, seed: int = 0, **settings: object) -> BatchWorld:
    world = BatchWorld(BatchConfig(num_envs=n, threads=1, **settings), seed=seed)  # type: ignore[arg-type]
    world.reset(np.arange(n), *stand(n))
    return world


def test_delay_switches_targets_at_its_time() -> None:
    old, new = np.zeros((3, 12)), np.ones((3, 12))
    out = delayed_controls(old, new, np.array([0.0, 0.004, 0.006]), 0.004, 4)[..., 0]
    # no delay; one whole substep; one and a half: the second substep is half old, half new
    assert out[0] == pytest.approx([1.0, 1.0, 1.0, 1.0])
    assert out[1] == pytest.approx([0.0, 1.0, 1.0, 1.0])
    assert out[2] == pytest.approx([0.0, 0.5, 1.0, 1.0])


def test_delay_keeps_the_impulse_of_the_zero_order_hold() -> None:
    rng = np.random.default_rng(0)
    delay = rng.uniform(0.0, 0.016, 50)
    out = delayed_controls(np.zeros((50, 12)), np.ones((50, 12)), delay, 1 / 240, 8)
    # ∫ target over the period = period − delay
    assert out.mean(axis=1)[:, 0] / 30 == pytest.approx(1 / 30 - delay)


def test_draws_fill_the_ranges_of_table_one() -> None:
    drawn = randomize.draw(np.random.default_rng(0), 20000, 13)
    slope = np.linalg.norm(drawn.slope_axis, axis=1)
    for values, (low, high) in (
        (drawn.mass, (0.75, 1.25)),
        (drawn.friction, (0.5, 1.5)),
        (drawn.kp, (0.7, 1.3)),
        (drawn.kd, (0.7, 1.3)),
        (drawn.delay, (0.0, 0.016)),
        (slope, (0.0, 0.14)),
    ):
        assert low <= values.min()
        assert values.max() <= high
        assert values.mean() == pytest.approx((low + high) / 2, rel=0.02)
        # the deviation of a uniform distribution is its width over √12
        assert values.std() == pytest.approx((high - low) / np.sqrt(12.0), rel=0.02)


def test_links_are_drawn_independently_of_each_other() -> None:
    mass = randomize.draw(np.random.default_rng(0), 5000, 13).mass
    off_diagonal = np.corrcoef(mass.T) - np.eye(13)
    assert np.abs(off_diagonal).max() < 0.06


def test_scale_zero_is_the_nominal_robot() -> None:
    drawn = randomize.draw(np.random.default_rng(0), 5, 13, scale=0.0)
    for values in (drawn.mass, drawn.friction, drawn.kp, drawn.kd):
        assert np.all(values == 1.0)
    assert not drawn.delay.any()
    assert not drawn.slope_axis.any()
    assert drawn.period == 0.0


def test_tilted_gravity_is_the_world_seen_from_the_slope() -> None:
    axis = np.array([[0.1, 0.0], [0.0, 0.14], [0.05, -0.08]])
    rotation = geometry.quat_from_rotvec(np.concatenate([axis, np.zeros((3, 1))], axis=1))
    down = np.tile([0.0, 0.0, -9.81], (3, 1))
    assert randomize.gravity(axis) == pytest.approx(geometry.quat_rotate_inverse(rotation, down))


def test_dynamics_reach_the_physics() -> None:
    world = make(2)
    drawn = randomize.draw(np.random.default_rng(5), 2, world.num_links)
    world.set_dynamics(np.arange(2), drawn)
    model = world._batch.get_model(1)
    assert model.body_mass[1:] == pytest.approx(world.model.body_mass[1:] * drawn.mass[1])
    # A link keeps its shape: as much heavier, as much harder to turn.
    inertia = world.model.body_inertia[1:] * drawn.mass[1][:, None]
    assert model.body_inertia[1:] == pytest.approx(inertia)
    assert model.geom_friction[:, 0] == pytest.approx(np.full(world.model.ngeom, drawn.friction[1]))
    assert model.actuator_gainprm[:, 0] == pytest.approx(np.full(12, a1.KP * drawn.kp[1]))
    assert model.actuator_biasprm[:, 2] == pytest.approx(np.full(12, -a1.KD * drawn.kd[1]))
    assert model.opt.gravity == pytest.approx(randomize.gravity(drawn.slope_axis)[1])


def test_dynamics_drawn_again_do_not_pile_up() -> None:
    world = make(2)
    for seed in (5, 6):
        drawn = randomize.draw(np.random.default_rng(seed), 2, world.num_links)
        world.set_dynamics(np.arange(2), drawn)
    model = world._batch.get_model(0)
    assert model.body_mass[1:] == pytest.approx(world.model.body_mass[1:] * drawn.mass[0])
    inertia = world.model.body_inertia[1:] * drawn.mass[0][:, None]
    assert model.body_inertia[1:] == pytest.approx(inertia)


def periods(world: BatchWorld, steps: int) -> np.ndarray:
    """(steps, N) s that each control period lasts, told by what falling robots gain: v = g t."""
    qpos, qvel = stand(len(world.qpos))
    qpos[:, 2] = 50.0
    world.reset(np.arange(len(qpos)), qpos, qvel)
    speed = [np.zeros(len(qpos))]
    for _ in range(steps):
        world.step(np.tile(a1.STAND_JOINT_POS, (len(qpos), 1)))
        speed.append(-np.array(world.base_lin_vel_w[:, 2]) / 9.81)
    return np.diff(speed, axis=0)


@pytest.mark.parametrize("scale", [1.0, 0.5])
def test_control_periods_jitter_within_their_range_anew_every_time(scale: float) -> None:
    world = make(200)
    drawn = randomize.draw(np.random.default_rng(0), 200, world.num_links, scale)
    world.set_dynamics(np.arange(200), replace(drawn, slope_axis=np.zeros((200, 2))))
    change = periods(world, 20) / a1.CONTROL_DT - 1.0
    largest = 0.1 * scale
    assert np.abs(change).max() < largest + 1e-3
    # uniform within ± the largest: deviation largest / √3
    assert change.std() == pytest.approx(largest / np.sqrt(3.0), rel=0.03)
    assert abs(change.mean()) < 0.05 * largest
    for a, b in ((change[:-1], change[1:]), (change[:, :-1], change[:, 1:])):  # times, robots
        assert abs(np.corrcoef(a.ravel(), b.ravel())[0, 1]) < 0.07


def test_a_nominal_robots_control_period_is_exact() -> None:
    assert periods(make(2), 5) == pytest.approx(np.full((5, 2), a1.CONTROL_DT), rel=1e-3)


def test_robots_do_not_feel_each_other() -> None:
    alone, together = make(1), make(3)
    together.push(np.array([1, 2]), np.array([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]))
    for _ in range(10):
        alone.step(alone.target)
        together.step(together.target)
    assert np.array_equal(alone.qpos[0], together.qpos[0])
    assert together.base_pos[1, 0] > 0.02


def test_a_batch_stands_for_three_seconds() -> None:
    world = make()
    for _ in range(90):
        world.step(np.tile(a1.STAND_JOINT_POS, (N, 1)))
    assert np.all(np.abs(world.base_pos[:, 2] - a1.STAND_HEIGHT) < 0.03)


def test_threads_do_not_change_the_result() -> None:
    results = []
    for threads in (1, 2):
        world = BatchWorld(BatchConfig(num_envs=6, threads=threads), seed=3)
        world.reset(np.arange(6), *stand(6))
        world.set_dynamics(
            np.arange(6), randomize.draw(np.random.default_rng(1), 6, world.num_links)
        )
        for k in range(8):
            world.step(np.tile(a1.STAND_JOINT_POS + 0.05 * k, (6, 1)))
        results.append(np.array(world.qpos))
    assert np.array_equal(*results)


def test_a_slope_makes_the_imu_lean() -> None:
    world = make(1)
    drawn = randomize.draw(np.random.default_rng(0), 1, world.num_links)
    world.set_dynamics(np.arange(1), drawn)
    rotvec = geometry.quat_to_rotvec(world.imu_quat[0])
    assert rotvec[:2] == pytest.approx(drawn.slope_axis[0])


def test_no_motor_pushes_a_joint_past_its_free_speed() -> None:
    qpos, qvel = stand(N)
    qpos[:, 2] = 5.0  # in the air, where nothing holds a leg back
    world = make()
    world.reset(np.arange(N), qpos, qvel)
    far = np.tile(a1.STAND_JOINT_POS, (N, 1))
    far[:, 1] += 3.0
    fastest = 0.0
    for _ in range(6):
        world.step(far)
        fastest = max(fastest, float(np.abs(world.joint_vel).max()))
    assert 10.0 < fastest <= a1.SPEED_LIMIT.min()


def test_a_slow_joint_has_all_of_its_torque() -> None:
    world = make()
    held = make(motor=MotorModel(free_speed=1e3))  # no torque-speed curve within reach
    for _ in range(5):
        world.step(np.tile(a1.STAND_JOINT_POS, (N, 1)))
        held.step(np.tile(a1.STAND_JOINT_POS, (N, 1)))
    np.testing.assert_array_equal(world.qpos, held.qpos)
