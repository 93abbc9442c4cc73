"""The environment as Gymnasium's: by its own checker, and as the README shows it."""

import re
import warnings
from pathlib import Path

import numpy as np
from gymnasium.utils.env_checker import check_env

from studio.rl.gym_env import A1Imitation

README = Path(__file__).parents[2] / "README.md"


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


def test_the_readmes_program_makes_it_by_its_id_and_steps_it() -> None:
    programs = re.findall(r"```python\n(.*?)```", README.read_text("utf-8"), re.DOTALL)
    (program,) = (text for text in programs if "gymnasium.make" in text)
    left: dict = {}
    exec(program, left)
    assert left["env"].unwrapped.__class__ is A1Imitation
    assert left["observation"].shape == (176,)
    assert 0.0 < left["reward"] < 2.0
