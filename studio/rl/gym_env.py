"""One robot as a Gymnasium environment, so that others can train on it with what they know.

gymnasium.make("studio.rl.gym_env:A1Imitation-v0", state="walk")
"""

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from studio.control.action import ACTION_CLIP
from studio.reference.intent import StateName
from studio.rl.bank import build_bank
from studio.rl.curriculum import Curriculum, stages
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig


class A1Imitation(gymnasium.Env[NDArray[np.float32], NDArray[np.float32]]):
    """Track one reference after another; an episode is one motion, from anywhere in it.

    Observation (176,) and action (12,) as `observation` and `action` define them; the reward is
    the paper's. `info` holds the reward's terms and the tracking figures of the step.
    state: whose motions. motions_per_task: how many are drawn. randomise: Table I's dynamics, kicks
    and noise, or the nominal robot.
    """

    metadata = {"render_modes": []}

    def __init__(
        self, state: StateName = "stand", motions_per_task: int = 4, randomise: bool = True
    ) -> None:
        self._bank = build_bank(state, per_task=motions_per_task)
        self._randomise = randomise
        self._env = self._make(0)
        dim = self._env.config.observation.dim
        self.observation_space = spaces.Box(-np.inf, np.inf, (dim,), dtype=np.float32)
        self.action_space = spaces.Box(-ACTION_CLIP, ACTION_CLIP, (12,), dtype=np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """A new motion and new dynamics; the same ones for the same seed."""
        super().reset(seed=seed)
        if seed is not None:
            self._env = self._make(seed)
        return self._env.reset()[0], {}

    def step(
        self, action: NDArray[np.float32]
    ) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """One control period."""
        observation, reward, terminated, truncated, extras = self._env.step(
            action[None].astype(np.float64)
        )
        info = {k: float(v[0]) for k, v in {**self._env.terms, **self._env.metrics}.items()}
        if terminated[0] or truncated[0]:
            # The vectorised environment has begun anew by now; Gymnasium wants what was seen last.
            observation = extras["ended_observation"]
        return observation[0], float(reward[0]), bool(terminated[0]), bool(truncated[0]), info

    def _make(self, seed: int) -> ImitationEnv:
        ladder = stages(self._bank.tasks)
        if not self._randomise:
            ladder = [stage for stage in ladder if stage.randomisation == 0.0]
        curriculum = Curriculum(ladder=ladder)
        curriculum.finish()
        config = EnvConfig(num_envs=1, threads=1)
        return ImitationEnv(config, self._bank, seed=seed, curriculum=curriculum)


gymnasium.register(id="A1Imitation-v0", entry_point="studio.rl.gym_env:A1Imitation")
