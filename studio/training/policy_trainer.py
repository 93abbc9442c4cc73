"""One training run of a policy: environment, PPO, what was taught; one iteration, and to a file.

Settings are `policy_settings`; how long it goes on and what is written when, `train_policy`.
"""

import time
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any, cast

import numpy as np
import torch

from studio import metrics
from studio.control.observation_frame import level_quat
from studio.control.policy import manifest_of
from studio.errors import StudioError
from studio.rl.env import ImitationEnv
from studio.rl.privileged import LearnedTeacher
from studio.training import checkpoint
from studio.training.device import random_states, restore_random_states
from studio.training.distil import Distiller
from studio.training.machine import commit, machine
from studio.training.parallel import SEED_STEP, SINGLE_PROCESS, ProcessGroup
from studio.training.policy_settings import PolicyTraining, algorithm_of, make_environment
from studio.training.ppo import TorchEnv, collect, make_algorithm

TAUGHT_STD = 0.1
"""Exploration, in units of action, with which PPO goes on after a teacher (0.025 rad)."""


class PolicyTrainer:
    """One run: environment, algorithm, counts. `step` is one iteration; one thread only."""

    def __init__(
        self,
        config: PolicyTraining,
        env: ImitationEnv | None = None,
        group: ProcessGroup = SINGLE_PROCESS,
    ) -> None:
        torch.manual_seed(config.seed)
        self.config, self.group = config, group
        self.ppo = algorithm_of(config)
        own = config.seed + SEED_STEP * group.rank
        self.env = TorchEnv(env or make_environment(config, seed=own), config.device)
        self.env.env.reset()
        self.alg = make_algorithm(self.env, self.ppo, group)
        torch.manual_seed(own)  # exploration is everyone's own
        self.alg.train_mode()
        self.samples, self.seconds, self.iteration = 0, 0.0, 0
        self.warmup = 0
        self.taught: dict[str, Any] | None = None  # by which teacher, for how many samples
        self.curve: list[dict[str, float]] = []
        self.obs = self.env.present()

    def teach(self, lessons: int, on_lesson: Callable[[dict[str, float]], None]) -> None:
        """Learn from the teacher for so many samples, under the last stage's dynamics."""
        env = self.env.env
        env.curriculum.finish()
        env.restart()
        teacher = LearnedTeacher(self.config.teacher) if self.config.teacher else None
        by = "analytic" if teacher is None else "learned"
        distiller = Distiller(self.alg, env, group=self.group, teacher=teacher)
        each = env.num_envs * distiller.config.horizon * self.group.size
        while self.samples < lessons:
            began = time.perf_counter()
            figures = distiller.lesson(self.samples / lessons)
            self.samples += each
            self.taught = {"by": by, "samples": self.samples}
            self.seconds += time.perf_counter() - began
            figures["samples_per_second"] = each / (time.perf_counter() - began)
            figures["joint_rmse_deg"] = metrics.rms_deg(figures.pop("joint_sq"))
            on_lesson(figures)
        self.warmup = self.config.warmup
        # What was taught is close already: explore around it, not past it.
        self.explore(TAUGHT_STD)
        self.obs = self.env.present()

    def explore(self, std: float) -> None:
        """Spread the actions by so much, in units of action, from here on."""
        with torch.no_grad():
            cast(Any, self.alg.actor.distribution).log_std_param.fill_(float(np.log(std)))

    def step(self) -> dict[str, float]:
        """Collect, learn, count; this iteration's figures."""
        began = time.perf_counter()
        self.obs, figures = collect(self.alg, self.env, self.obs, self.ppo.horizon)
        collected = time.perf_counter()
        losses = self._warm_up() if self.warmup else self.alg.update()
        # The adaptive rate may run up where there is little to learn; the critic shares it.
        self.alg.learning_rate = min(self.alg.learning_rate, self.ppo.max_learning_rate)
        spent = time.perf_counter() - began
        each = self.env.num_envs * self.ppo.horizon * self.group.size
        self.samples += each
        self.seconds += spent
        self.iteration += 1
        self._agree()
        return {
            **figures.means(),
            **{f"loss/{k}": float(v) for k, v in losses.items()},
            "samples_per_second": each / spent,
            "collect_share": (collected - began) / spent,
            "learning_rate": self.alg.learning_rate,
            "action_std": float(self.alg.actor.output_std.detach().mean()),
            "stage": float(self.env.env.curriculum.level),
        }

    def _agree(self) -> None:
        """Every process trains on the stage that the first one has reached."""
        curriculum = self.env.env.curriculum
        level = int(self.group.broadcast(curriculum.level))
        if level != curriculum.level:
            curriculum.load({"level": level, "episodes": 0, "ratio": 0.0})
            self.env.env.follow_curriculum()

    def _warm_up(self) -> dict[str, float]:
        """An update of the critic alone, at a rate of its own; the actor is put back."""
        actor = self.alg.actor
        learnt = [p.detach().clone() for p in actor.parameters()]
        schedule, rate = self.alg.schedule, self.alg.learning_rate
        self._set_rate("fixed", 1e-3)
        losses = self.alg.update()
        self._set_rate(schedule, rate)
        with torch.no_grad():
            for parameter, value in zip(actor.parameters(), learnt, strict=True):
                parameter.copy_(value)
                # Nor may the optimiser remember steps that were taken back.
                self.alg.optimizer.state.pop(parameter, None)
        self.warmup -= 1
        return losses

    def _set_rate(self, schedule: str, rate: float) -> None:
        self.alg.schedule, self.alg.learning_rate = schedule, rate
        for group in self.alg.optimizer.param_groups:
            group["lr"] = rate

    def save(self, path: Path) -> None:
        """Everything, to one file."""
        tensors = {f"actor.{k}": v for k, v in self.alg.actor.state_dict().items()}
        tensors |= {f"critic.{k}": v for k, v in self.alg.critic.state_dict().items()}
        tensors |= checkpoint.flatten_optimizer(self.alg.optimizer)
        tensors |= random_states(self.env.device)
        facts = {
            # Without where things lay on the machine that ran it.
            "config": {k: v for k, v in asdict(self.config).items() if not isinstance(v, Path)},
            "taught": self.taught,
            "samples": self.samples,
            "seconds": self.seconds,
            "iteration": self.iteration,
            "warmup": self.warmup,
            "learning_rate": self.alg.learning_rate,
            "curriculum": self.env.env.curriculum.state(),
            "random_state": checkpoint.random_state(self.env.env.rng),
            "curve": self.curve,
        }
        checkpoint.save(path, tensors, facts)

    def restore(self, path: Path) -> None:
        """Back to a checkpoint; the environments are drawn again under its curriculum.

        Raises StudioError if it is damaged, of another state, or made with other settings.
        """
        tensors, facts = checkpoint.load(path)
        if facts["config"]["state"] != self.config.state:
            raise StudioError(
                f"{path} is of state {facts['config']['state']}, not {self.config.state}"
            )
        for name, model in (("actor", self.alg.actor), ("critic", self.alg.critic)):
            own = {k[len(name) + 1 :]: v for k, v in tensors.items() if k.startswith(name + ".")}
            try:
                model.load_state_dict(own)
            except RuntimeError as error:
                raise StudioError(
                    f"{path} was made with other settings; start without it"
                ) from error
        checkpoint.restore_optimizer(self.alg.optimizer, tensors)
        self._set_rate(self.alg.schedule, facts["learning_rate"])
        self.warmup = int(facts.get("warmup", 0))
        if self.warmup and self.warmup == facts["config"]["warmup"]:  # not begun: as asked now
            self.warmup = self.config.warmup
        self.samples, self.seconds = int(facts["samples"]), float(facts["seconds"])
        analytic = {"by": "analytic", "samples": self.config.lessons}
        self.taught = facts.get("taught", analytic if self.config.lessons else None)
        self.iteration, self.curve = int(facts["iteration"]), list(facts["curve"])
        self.env.env.curriculum.load(facts["curriculum"])
        self.env.env.restart()
        if self.group.is_main:  # of the others no RNG state was saved: they keep their seed's
            self.env.env.rng.bit_generator.state = facts["random_state"]
            restore_random_states(self.env.device, tensors)
        self.obs = self.env.present()

    def tensors(self) -> dict[str, np.ndarray]:
        """Normaliser and layers as Policy reads them; shapes: see `save_policy`."""
        actor = self.alg.actor
        linear = [m for m in actor.mlp.modules() if isinstance(m, torch.nn.Linear)]
        normaliser = cast(Any, actor.obs_normalizer)
        out = {
            "mean": normaliser._mean.cpu().numpy()[0],
            "std": normaliser._std.cpu().numpy()[0] + normaliser.eps,
        }
        for i, layer in enumerate(linear):
            out[f"weight_{i}"] = layer.weight.detach().cpu().numpy()
            out[f"bias_{i}"] = layer.bias.detach().cpu().numpy()
        return {k: np.ascontiguousarray(v, dtype=np.float32) for k, v in out.items()}

    def manifest(self, **facts: Any) -> dict[str, Any]:
        """The sidecar: how to run the weights, and what they are made of."""
        config, settings = self.config, self.env.env.config
        return manifest_of(
            config.state,
            settings.observation,
            settings.action,
            np.array(level_quat(config.level)),
            self.env.env.neutral,
            samples=self.samples,
            hours=round(self.seconds / 3600.0, 3),
            seed=config.seed,
            commit=commit(),
            # what was really learnt from the teacher, whatever the recipe would have
            recipe={
                "distil": self.taught["samples"] if self.taught else 0,
                **asdict(config.made_by),
            },
            lessons=self.taught["samples"] if self.taught else 0,
            teacher=self.taught["by"] if self.taught else None,
            curriculum=config.curriculum,
            randomise=config.randomise,
            preset=config.preset,
            push=config.push,
            machine={**machine(), "device": config.device},
            tasks=list(self.env.env.bank.tasks),
            symmetric=self.ppo.mirror or self.ppo.mirror_loss > 0.0,
            transitions=any(t.startswith("from_") for t in self.env.env.bank.tasks),
            stage=self.env.env.curriculum.level,
            stages=len(self.env.env.curriculum.ladder),
            curve=self.curve,
            **facts,
        )
