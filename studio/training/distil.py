"""A teacher that sees the clean future → a policy that does not: supervised, on its own way.

DAgger: the student acts, the teacher says what it would have done there, the student regresses on
all recent answers. It needs a hundredth of the samples that PPO takes to learn to read noise, and
hands PPO a policy to improve.
"""

import logging
from collections import deque
from collections.abc import Callable
from dataclasses import dataclass, field
from functools import partial

import numpy as np
import torch
from rsl_rl.algorithms import PPO

from studio.control.symmetry import observation_mirror
from studio.rl.env import ImitationEnv
from studio.rl.teacher import TeacherConfig, teacher_action
from studio.robot.a1 import MIRROR_JOINT, MIRROR_SIGN
from studio.training.parallel import SINGLE_PROCESS, ProcessGroup
from studio.training.ppo import mirror_tensors

log = logging.getLogger(__name__)
Teacher = Callable[[ImitationEnv], np.ndarray]
"""The environment as it stands → (N, 12), the actions that the student should have taken."""


@dataclass(frozen=True, kw_only=True)
class DistilConfig:
    """horizon: control periods between lessons. keep: lessons remembered. passes: over the newest
    lesson's number of samples, drawn from all that are kept. noise: of the student's actions.
    hip_weight: of the hips' errors, whose small angles steer. teacher: of the analytic one.
    """

    horizon: int = 24
    keep: int = 24
    passes: int = 3
    minibatch: int = 1024
    learning_rate: float = 1e-3
    final_learning_rate: float = 2e-4
    noise: float = 0.1
    hip_weight: float = 4.0
    teacher: TeacherConfig = field(default_factory=TeacherConfig)


class Distiller:
    """Lessons for one actor in one environment; one thread only."""

    def __init__(
        self,
        alg: PPO,
        env: ImitationEnv,
        config: DistilConfig = DistilConfig(),
        group: ProcessGroup = SINGLE_PROCESS,
        teacher: Teacher | None = None,
    ) -> None:
        self.alg, self.env, self.config, self.group = alg, env, config, group
        self.teacher = teacher or partial(teacher_action, config=config.teacher)
        parameters = list(alg.actor.mlp.parameters())
        self.optimizer = torch.optim.Adam(parameters, lr=config.learning_rate)
        self.lessons: deque[tuple[torch.Tensor, torch.Tensor]] = deque(maxlen=config.keep)
        self.device = str(alg.device)
        self.mirror = mirror_tensors(observation_mirror(env.config.observation), self.device)
        self.joints = mirror_tensors((MIRROR_JOINT, MIRROR_SIGN), self.device)
        self.weight = torch.tensor([config.hip_weight, 1.0, 1.0], device=self.device).repeat(4)
        self.rng = np.random.default_rng(group.rank)

    def lesson(self, progress: float) -> dict[str, float]:
        """Act, ask, learn; progress in [0, 1] of all lessons. Mean error and tracking figures."""
        observations, answers = [], []
        sums = {"joint_sq": 0.0, "foot_error": 0.0, "tilt_error": 0.0, "tracked": 0.0}
        observation = self.env.observation()
        for _ in range(self.config.horizon):
            answer = self.teacher(self.env)
            observations.append(observation)
            answers.append(answer.astype(np.float32))
            with torch.inference_mode():
                x = torch.from_numpy(observation).to(self.device)
                x = self.alg.actor.mlp(self.alg.actor.obs_normalizer(x))
                action = x.cpu().numpy().astype(np.float64)
            action += self.config.noise * self.rng.standard_normal(action.shape)
            observation = self.env.step(action)[0]
            for name in sums:
                sums[name] += float(self.env.metrics[name].mean()) / self.config.horizon
        new = (
            torch.from_numpy(np.concatenate(observations)).to(self.device),
            torch.from_numpy(np.concatenate(answers)).to(self.device),
        )
        self.lessons.append(new)
        self.alg.actor.obs_normalizer.update(new[0])  # type: ignore[operator]
        return {"imitation_loss": self._learn(len(new[0]), progress), **sums}

    def _learn(self, count: int, progress: float) -> float:
        """Regress on samples of all kept lessons, half of them seen in the mirror."""
        c = self.config
        rate = c.learning_rate * (c.final_learning_rate / c.learning_rate) ** progress
        for group in self.optimizer.param_groups:
            group["lr"] = rate
        observations, answers = (torch.cat(part) for part in zip(*self.lessons, strict=True))
        losses = []
        for _ in range(max(c.passes * count // c.minibatch, 1)):  # few robots learn too
            drawn = self.rng.integers(0, len(observations), c.minibatch)
            rows = torch.from_numpy(drawn).to(self.device)
            x, y = observations[rows], answers[rows]
            half = c.minibatch // 2
            x = torch.cat([x[:half], x[half:, self.mirror[0]] * self.mirror[1]])
            y = torch.cat([y[:half], y[half:, self.joints[0]] * self.joints[1]])
            error = self.alg.actor.mlp(self.alg.actor.obs_normalizer(x)) - y
            loss = (self.weight * error.square()).mean()
            self.optimizer.zero_grad()
            loss.backward()
            self.group.average_gradients(list(self.alg.actor.mlp.parameters()))
            torch.nn.utils.clip_grad_norm_(self.alg.actor.mlp.parameters(), 1.0)
            self.optimizer.step()
            losses.append(float(loss.detach()))
        return float(np.mean(losses))
