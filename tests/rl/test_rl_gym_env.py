"""The environment as Gymnasium's: by its own checker, and made by its id."""

import warnings

import gymnasium
import numpy as np
from gymnasium.utils.env_checker import check_env

from studio.rl.gym_env import A1Imitation


def test_gymnasium_wrapper_passes_gymnasiums_own_checker() -> None:
    env = A1Imitation("stand", motions_per_task=1)
    with warnings.catch_warnings():
        # Unbounded observations and actions beyond ±1 are meant: the checker only remarks on them.
        warnings.simplefilter("ignore", UserWarning)
        check_env(env, skip_render_check=True)


def test_gymnasium_gets_what_a_fallen_robot_saw_last_and_not_the_next_episode() -> None:
    env = A1Imitation("stand", motions_per_task=1)
    before, _ = env.reset(seed=0)
    fold = np.tile([0.0, 4.0, 4.0], 4).astype(np.float32)  # thighs forward, calves stretched
    for _ in range(60):
        last, _, terminated, truncated, _ = env.step(fold)
        if terminated or truncated:
            break
        before = last
    assert terminated
    z, action = last[:68].reshape(4, 17), last[68:104].reshape(3, 12)
    # The same history, one frame on; a new episode's frames are all alike and without actions.
    assert np.array_equal(z[:3], before[17:68].reshape(3, 17))
    assert np.array_equal(action[-1], fold)
    # On its trunk, all thighs half a radian past standing: nothing a new episode begins with.
    assert np.all(z[3, 1:12:3] > env._env.neutral[1::3] + 0.5)
    fresh, _ = env.reset(seed=0)
    assert np.array_equal(fresh[:17], fresh[51:68])


def test_gymnasium_makes_it_by_its_id() -> None:
    env = gymnasium.make("studio.rl.gym_env:A1Imitation-v0", state="stand")
    assert env.unwrapped.__class__ is A1Imitation
    observation, _ = env.reset(seed=0)
    assert observation.shape == (176,)
    assert 0.0 < float(env.step(env.action_space.sample())[1]) < 2.0
