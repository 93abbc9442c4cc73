"""rsl-rl's PPO around the imitation environment: settings, rollouts, mirrored copies, figures."""

import contextlib
import io
from dataclasses import dataclass
from typing import Any, cast

import numpy as np
import torch
from rsl_rl.algorithms import PPO
from tensordict import TensorDict

from studio import metrics
from studio.control.symmetry import observation_mirror, privileged_mirror
from studio.rl.env import ImitationEnv
from studio.robot.a1 import MIRROR_JOINT, MIRROR_SIGN
from studio.timing import CONTROL_HZ
from studio.training.device import threads
from studio.training.parallel import SINGLE_PROCESS, ProcessGroup
from studio.training.usual import Usual


@dataclass(frozen=True, kw_only=True)
class PpoConfig:
    """PPO's own figures; `PAPER` holds those of the paper.

    mirror: learn from mirrored copies of every sample. mirror_loss: weight of the squared
    difference between the mirrored mean action and the action on the mirrored observation.
    """

    horizon: int = 24
    epochs: int = 4
    minibatch: int = 1536
    clip: float = 0.2
    learning_rate: float = 5e-4
    max_learning_rate: float = Usual(2e-3)
    desired_kl: float | None = Usual(0.015)
    gamma: float = Usual(0.95)
    lam: float = 0.95
    entropy: float = 0.0005
    max_grad_norm: float = 1.0
    init_std: float = 0.2
    max_std: float = 0.3
    hidden: tuple[int, ...] = (256, 256)
    mirror: bool = True
    mirror_loss: float = 0.0


PAPER = PpoConfig(
    horizon=128,
    epochs=10,
    minibatch=128,
    learning_rate=5e-5,
    desired_kl=None,
    max_grad_norm=0.5,
    entropy=0.0,
    mirror=False,
)


class TorchEnv:
    """The environment as rsl-rl's algorithm reads it: tensors, `num_envs`, `num_actions`.

    The environment is numpy's and stays on the processor; its tensors lie on `device`.
    """

    num_actions = 12

    def __init__(self, env: ImitationEnv, device: str = "cpu") -> None:
        self.env, self.num_envs, self.device = env, env.num_envs, device
        self._mirror = {
            "actor": mirror_tensors(observation_mirror(env.config.observation), device),
            "privileged": mirror_tensors(privileged_mirror(), device),
            "action": mirror_tensors((MIRROR_JOINT, MIRROR_SIGN), device),
        }

    def tensors(self, actor: np.ndarray, privileged: np.ndarray) -> TensorDict:
        """Groups "actor" (N, dim) and "privileged" (N, PRIVILEGED_DIM); the critic sees both."""
        groups = {"actor": self.tensor(actor), "privileged": self.tensor(privileged)}
        return TensorDict(groups, batch_size=[len(actor)])

    def tensor(self, array: np.ndarray) -> torch.Tensor:
        """The same array, in its shape, on the learner's device."""
        return torch.from_numpy(array).to(self.device)

    def present(self) -> TensorDict:
        """What is observed now."""
        return self.tensors(self.env.observation(), self.env.privileged())

    def mirrored(
        self, env: Any, obs: TensorDict | None, actions: torch.Tensor | None
    ) -> tuple[TensorDict | None, torch.Tensor | None]:
        """rsl-rl's augmentation: the batch, then the same batch seen in a mirror.

        Groups (B, dim) become (2B, dim), actions (B, 12) become (2B, 12).
        """
        both = None
        if obs is not None:
            groups = {}
            for name, mirror in self._mirror.items():
                if name != "action":
                    groups[name] = _with_mirror(cast(torch.Tensor, obs[name]), *mirror)
            both = TensorDict(groups, batch_size=[2 * obs.batch_size[0]])
        return both, None if actions is None else _with_mirror(actions, *self._mirror["action"])


def mirror_tensors(
    index_sign: tuple[np.ndarray, np.ndarray], device: str
) -> tuple[torch.Tensor, torch.Tensor]:
    """Index and sign (dim,) of a mirror (`control.symmetry`) on the learner's device."""
    index, sign = index_sign
    on = torch.device(device)
    return torch.as_tensor(index, device=on), torch.as_tensor(sign, dtype=torch.float32, device=on)


def _with_mirror(x: torch.Tensor, index: torch.Tensor, sign: torch.Tensor) -> torch.Tensor:
    return torch.cat([x, x.index_select(-1, index) * sign])


def make_algorithm(env: TorchEnv, ppo: PpoConfig, group: ProcessGroup = SINGLE_PROCESS) -> PPO:
    """rsl-rl's PPO with an asymmetric critic, observation normalisation and mirrored copies."""
    network = {
        "class_name": "rsl_rl.models:MLPModel",
        "hidden_dims": list(ppo.hidden),
        "activation": "relu",
        "obs_normalization": True,
    }
    gaussian = {
        "class_name": "rsl_rl.modules.distribution:GaussianDistribution",
        "init_std": ppo.init_std,
        "std_range": (0.02, ppo.max_std),
        "std_type": "log",
    }
    batch = env.num_envs * ppo.horizon
    algorithm: dict[str, Any] = {
        "class_name": PPO,
        "num_learning_epochs": ppo.epochs,
        "num_mini_batches": max(batch // ppo.minibatch, 1),
        "clip_param": ppo.clip,
        "gamma": ppo.gamma,
        "lam": ppo.lam,
        "entropy_coef": ppo.entropy,
        "learning_rate": ppo.learning_rate,
        "max_grad_norm": ppo.max_grad_norm,
        "schedule": "adaptive" if ppo.desired_kl else "fixed",
        "desired_kl": ppo.desired_kl,
    }
    if ppo.mirror or ppo.mirror_loss:
        # A plain function: the settings are deep-copied, and the environment must not be.
        algorithm["symmetry_cfg"] = {
            "data_augmentation_func": lambda **batch: env.mirrored(**batch),
            "use_data_augmentation": ppo.mirror,
            "use_mirror_loss": ppo.mirror_loss > 0.0,
            "mirror_loss_coeff": ppo.mirror_loss,
        }
    settings = {
        "num_steps_per_env": ppo.horizon,
        "obs_groups": {"actor": ["actor"], "critic": ["actor", "privileged"]},
        "actor": {**network, "distribution_cfg": gaussian},
        "critic": dict(network),
        "algorithm": algorithm,
        "multi_gpu": group.settings,
    }
    with contextlib.redirect_stdout(io.StringIO()):  # the library prints its models
        alg = PPO.construct_algorithm(env.present(), cast(Any, env), settings, env.device)
    if alg.symmetry is not None and not ppo.mirror_loss:
        # It would forward the whole mirrored batch once more for a figure nobody reads.
        alg.symmetry.compute_loss = lambda *_: torch.zeros(())  # type: ignore[method-assign]
    # A zero last layer: training starts as PD playback, not as noise about it.
    last = [m for m in alg.actor.mlp.modules() if isinstance(m, torch.nn.Linear)][-1]
    with torch.no_grad():
        last.weight.mul_(0.01)
        last.bias.zero_()
    if group.size > 1:
        alg.broadcast_parameters()
    return alg


class Figures:
    """Means over a rollout of reward, terms, metrics and ends, by name."""

    def __init__(self) -> None:
        self.sums: dict[str, float] = {}
        self.steps = 0
        self.ratios: list[float] = []

    def add(
        self,
        env: ImitationEnv,
        rewards: np.ndarray,
        terminated: np.ndarray,
        truncated: np.ndarray,
        extras: dict[str, Any],
    ) -> None:
        """One step's rewards and ends, each (N,), and what the environment says beside them."""
        now = {"reward": rewards.mean(), "fall_rate": terminated.mean() * CONTROL_HZ}
        now |= {f"term/{k}": v.mean() for k, v in env.terms.items()}
        now |= {f"metric/{k}": v.mean() for k, v in env.metrics.items()}
        for name, value in now.items():
            self.sums[name] = self.sums.get(name, 0.0) + float(value)
        self.ratios += [float(r) for r in extras.get("episode_tracked_ratio", ())]
        self.steps += 1

    def means(self) -> dict[str, float]:
        """Per-step means; joint RMSE in degrees; tracked-time ratio of the ended episodes."""
        out = {k: v / self.steps for k, v in self.sums.items()}
        out["joint_rmse_deg"] = metrics.rms_deg(out.pop("metric/joint_sq"))
        if self.ratios:
            out["tracked_time_ratio"] = float(np.mean(self.ratios))
        return out


ROBOTS_PER_THREAD = 1024
"""Fewer are not worth waking a thread for: having acted, it spins for milliseconds (4 of them
measured, in every control period) on a core that the physics wants."""


def threads_to_act(num_envs: int) -> int:
    """As many of torch's threads as acting pays for."""
    return min(torch.get_num_threads(), max(1, num_envs // ROBOTS_PER_THREAD))


def collect(alg: PPO, env: TorchEnv, obs: TensorDict, horizon: int) -> tuple[TensorDict, Figures]:
    """One rollout into the algorithm's storage; the next observations and its mean figures."""
    figures = Figures()
    with torch.inference_mode():
        with threads(threads_to_act(env.num_envs)):
            for _ in range(horizon):
                actions = alg.act(obs)
                raw, rewards, terminated, truncated, extras = env.env.step(actions.cpu().numpy())
                figures.add(env.env, rewards, terminated, truncated, extras)
                rewards = env.tensor(rewards.astype(np.float32))
                if "final_ids" in extras:
                    # Time ran out, nothing failed: the return goes on with the value of what the
                    # robot last saw (rsl-rl itself would take the value of the state before).
                    last = env.tensors(extras["final_observation"], extras["final_privileged"])
                    value = alg.critic(last).squeeze(-1)
                    rewards[env.tensor(extras["final_ids"])] += alg.gamma * value
                obs = env.tensors(raw, env.env.privileged())
                dones = env.tensor(terminated | truncated).to(torch.uint8)
                alg.process_env_step(obs, rewards, dones, {})
        alg.compute_returns(obs)
    return obs, figures
