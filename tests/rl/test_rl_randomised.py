"""What training adds to clean numbers, by its statistics: sensor noise, biases and kicks."""

import numpy as np
import pytest

from studio import geometry
from studio.control.observation_frame import roll_pitch
from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.noise import NoiseConfig
from studio.robot import a1
from studio.sim import randomize

N, LOOKS = 400, 60
NOISE = NoiseConfig()


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("stand", per_task=1, seconds=2.0, difficulties=(0.4,))


def environment(
    bank: MotionBank, randomisation: float = 1.0, n: int = N, **settings: object
) -> ImitationEnv:
    stage = Rung(tasks=bank.tasks, difficulty=0.4, randomisation=randomisation)
    config = EnvConfig(num_envs=n, threads=1, **settings)  # type: ignore[arg-type]
    env = ImitationEnv(config, bank, seed=0, curriculum=Curriculum(ladder=[stage]))
    env.reset()
    return env


def sensed(env: ImitationEnv) -> tuple[np.ndarray, np.ndarray]:
    """Errors of LOOKS looks at robots that do not move: mean (N, 17), what is left (LOOKS, N, 17).

    The trunk's own rates, tilt and joints are the simulator's.
    """
    w = env.world
    truth = np.concatenate([w.joint_pos, roll_pitch(w.imu_quat), w.base_ang_vel_b], axis=1)
    error = np.stack([env._sensors() for _ in range(LOOKS)]) - truth
    return error.mean(axis=0), error - error.mean(axis=0)


@pytest.mark.parametrize("randomisation", [1.0, 0.5])
def test_sensors_have_the_noise_and_the_biases_they_are_said_to(
    bank: MotionBank, randomisation: float
) -> None:
    bias, noise = sensed(environment(bank, randomisation))
    # The mean of n looks still holds noise of σ / √n; what is left lacks as much.
    left = np.sqrt(1.0 - 1.0 / LOOKS)
    expected = randomisation * np.array([NOISE.encoder_bias, NOISE.imu_bias, 0.0])
    jitter = randomisation * np.array([NOISE.encoder, 0.0, NOISE.gyro])
    for k, part in enumerate((slice(0, 12), slice(12, 14), slice(14, 17))):
        assert noise[..., part].std() == pytest.approx(left * jitter[k], rel=0.03, abs=1e-9)
        spread = np.hypot(expected[k], jitter[k] / np.sqrt(LOOKS))
        assert bias[:, part].std() == pytest.approx(spread, rel=0.08, abs=1e-9)
        assert abs(bias[:, part].mean()) < 5.0 * spread / np.sqrt(bias[:, part].size) + 1e-9
    # Every joint and robot has a bias of its own, and noise one look does not share with the next.
    apart = np.corrcoef(bias[:, :14].T) - np.eye(14)
    assert np.abs(apart).max() < 0.25
    assert abs(np.corrcoef(noise[0, :, :12].ravel(), noise[1, :, :12].ravel())[0, 1]) < 0.06


def test_sensors_are_exact_without_randomisation(bank: MotionBank) -> None:
    bias, noise = sensed(environment(bank, randomisation=0.0, n=16))
    assert np.abs(bias).max() < 1e-9
    assert np.abs(noise).max() < 1e-9


def test_a_bias_lasts_an_episode_and_no_longer(bank: MotionBank) -> None:
    env = environment(bank, n=8)
    before = env.bias.copy()
    env.step(np.zeros((8, 12)))
    assert np.array_equal(env.bias, before)
    env.world.qpos[5, 3:7] = geometry.quat_from_rpy([np.pi / 2, 0.0, 0.0])
    terminated = env.step(np.zeros((8, 12)))[2]
    assert list(np.flatnonzero(terminated)) == [5]
    assert np.all(env.bias[5] != before[5])
    assert np.array_equal(np.delete(env.bias, 5, 0), np.delete(before, 5, 0))


def kicks(env: ImitationEnv, periods: int) -> np.ndarray:
    """(periods, N, 18) changes of velocity."""
    out = np.empty((periods, env.num_envs, 18))
    for k in range(periods):
        before = np.array(env.world.qvel)
        env._push()
        out[k] = env.world.qvel - before
    return out


@pytest.mark.parametrize("randomisation", [1.0, 0.5])
def test_kicks_come_at_their_interval_with_their_size_from_everywhere(
    bank: MotionBank, randomisation: float
) -> None:
    env = environment(bank, randomisation, push=0.4, push_every=2.0)
    given = kicks(env, 600)
    assert not given[..., 2:].any()  # along the floor, no turning
    kick = given[..., :2]
    size = np.linalg.norm(kick, axis=-1)
    hit = size > 0.0
    # 400 robots for 20 s, one in 2 s on average: 4000 ± 63
    assert hit.sum() == pytest.approx(N * 600 * a1.CONTROL_DT / 2.0, rel=0.06)
    # Nobody remembers the last one: as many a robot as chance would have, var = mean (1 − p).
    each = hit.sum(axis=0)
    assert each.var() == pytest.approx(each.mean() * (1.0 - 1.0 / 60.0), rel=0.3)
    # uniform up to the largest: mean half of it, deviation its width over √12
    largest = 0.4 * randomisation
    assert size.max() <= largest
    assert size[hit].mean() == pytest.approx(largest / 2.0, rel=0.05)
    assert size[hit].std() == pytest.approx(largest / np.sqrt(12.0), rel=0.05)
    directions = kick[hit] / size[hit][:, None]
    assert np.abs(directions.mean(axis=0)).max() < 0.06
    assert directions.var(axis=0) == pytest.approx([0.5, 0.5], rel=0.06)


@pytest.mark.parametrize(("randomisation", "evaluation"), [(0.0, False), (1.0, True)])
def test_nobody_is_kicked_without_randomisation_or_in_an_evaluation(
    bank: MotionBank, randomisation: float, evaluation: bool
) -> None:
    env = environment(bank, randomisation, n=16, push_every=a1.CONTROL_DT, evaluation=evaluation)
    assert not kicks(env, 5).any()


def test_kicks_happen_within_a_step(bank: MotionBank) -> None:
    speeds = []
    for push in (0.0, 2.0):
        env = environment(bank, n=16, push=push, push_every=a1.CONTROL_DT)
        env.step(np.zeros((16, 12)))
        speeds.append(np.linalg.norm(env.world.base_lin_vel_w[:, :2], axis=1).mean())
    assert speeds[1] > speeds[0] + 0.3


def test_steep_slopes_are_met_more_often_and_nothing_else_changes() -> None:
    even = randomize.draw(np.random.default_rng(0), 4000, 3)
    steep = randomize.steepened(even, np.random.default_rng(1), 0.4)
    size = np.linalg.norm(steep.slope_axis, axis=1) / randomize.TABLE_I.slope[1]
    changed = np.any(steep.slope_axis != even.slope_axis, axis=1)
    assert changed.mean() == pytest.approx(0.4, abs=0.03)
    low, high = randomize.STEEP
    assert size[changed].min() >= low
    assert size[changed].max() <= high
    assert size[changed].max() > 1.05  # beyond the end
    mean = steep.slope_axis[changed].mean(axis=0)
    assert mean == pytest.approx([0.0, 0.0], abs=0.02)  # rad: every direction
    assert np.array_equal(steep.mass, even.mass)
    assert steep.period == even.period
