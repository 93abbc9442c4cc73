"""rsl-rl's PPO with the same equations in a third less time: values in one go, gradients by hand.

The networks, storage, returns and settings are rsl-rl's. What is our own: the critic looks at a
rollout once, when it is over; observations are normalised (and mirrored) once a rollout instead of
once a minibatch and epoch; and a minibatch's gradients are written straight into place by the chain
rule below, without autograd's graph and the memory it asks for. Not for recurrent networks, RND or
mixed precision.
"""

import math
from typing import Any, cast

import torch
from rsl_rl.algorithms import PPO
from tensordict import TensorDict
from torch import Tensor, distributed, nn

from studio.training.layers import Layers

_LOG_ROOT = 0.5 * math.log(2.0 * math.pi)


def surrogate(log_ratio: Tensor, advantage: Tensor, clip: float) -> tuple[Tensor, Tensor]:
    """PPO's clipped loss and its derivative by each log-probability, (N, 1) each.

    With r = exp(log_ratio): L = mean max(−A r, −A clamp(r, 1 ± clip)), dL/dlog p = −A r / N where
    the first is the larger, and 0 where the clamp is.
    """
    ratio = log_ratio.exp()
    plain = -advantage * ratio
    clipped = -advantage * ratio.clamp(1.0 - clip, 1.0 + clip)
    return torch.maximum(plain, clipped).mean(), plain * (plain >= clipped) / len(plain)


def value_loss(value: Tensor, before: Tensor, target: Tensor, clip: float) -> tuple[Tensor, Tensor]:
    """The clipped squared error and its derivative by each value, (N, 1) each.

    L = mean max((V − R)², (V₀ + clamp(V − V₀, ± clip) − R)²): beyond the clamp the second, where it
    is the larger, no longer depends on V.
    """
    moved = value - before
    error = value - target
    clipped = before + moved.clamp(-clip, clip) - target
    loss, other = error.square(), clipped.square()
    counts = (loss >= other) | (moved.abs() <= clip)
    return torch.maximum(loss, other).mean(), 2.0 * error * counts / len(value)


def follow(normaliser: Any, x: Tensor) -> None:
    """`EmpiricalNormalization.update` by samples (N, F), of every process.

    Its `torch.var` over the first axis takes six times as long as the same in two passes.
    """
    count, mean = len(x), x.mean(dim=0, keepdim=True)
    many = distributed.get_world_size() if distributed.is_initialized() else 1
    if many > 1:
        distributed.all_reduce(mean)
        mean /= many
    var = (x - mean).square_().mean(dim=0, keepdim=True)
    if many > 1:
        distributed.all_reduce(var)
        var /= many
    normaliser.count += count * many
    rate = count * many / normaliser.count
    delta = mean - normaliser._mean
    normaliser._mean += rate * delta
    normaliser._var += rate * (var - normaliser._var + delta * (mean - normaliser._mean))
    normaliser._std = normaliser._var.sqrt()


class Learner(PPO):
    """PPO for `MLPModel`s with a Gaussian of one spread (`std_type` "log"); one thread only."""

    def __init__(self, *args: Any, **settings: Any) -> None:
        super().__init__(*args, **settings)
        both = [*self.actor.parameters(), *self.critic.parameters()]
        self.optimizer = torch.optim.Adam(both, lr=self.learning_rate, fused=True)
        self.log_std = cast(nn.Parameter, cast(Any, self.actor.distribution).log_std_param)
        self._samples = self.storage.num_envs * self.storage.num_transitions_per_env
        self._size = self._samples // self.num_mini_batches
        self.copies = self.symmetry is not None and self.symmetry.use_data_augmentation
        self.mirror_loss = self.symmetry is not None and self.symmetry.use_mirror_loss
        reflected = 2 if self.copies or self.mirror_loss else 1
        self._actor = Layers(self.actor.mlp, reflected * self._size)
        self._critic = Layers(self.critic.mlp, (2 if self.copies else 1) * self._size)
        # All gradients in one tensor: one norm a network, one step.
        self._split = sum(p.numel() for p in self.actor.parameters())
        self._gradient = torch.zeros(sum(p.numel() for p in both))
        self._unknown = torch.zeros(self.storage.num_envs, 1)
        self._inputs: tuple[Tensor, Tensor, Tensor] | None = None

    def act(self, obs: TensorDict) -> Tensor:
        """Sampled actions (N, 12); what they are worth, `compute_returns` asks for all steps."""
        now, actions = self.transition, self.actor(obs, stochastic_output=True)
        now.observations, now.actions, now.values = obs, actions, self._unknown
        now.actions_log_prob = self.actor.get_output_log_prob(actions)
        now.distribution_params = self.actor.output_distribution_params
        return actions

    @torch.no_grad()
    def compute_returns(self, obs: TensorDict) -> None:
        """Values, returns and advantages of the rollout; obs: what follows it."""
        st = self.storage
        seen = cast(TensorDict, st.observations.flatten(0, 1))
        if self.copies or self.mirror_loss:
            seen, _ = cast(Any, self.symmetry).data_augmentation_func(
                env=None, obs=seen, actions=None
            )
        actor = self.actor.get_latent(seen)
        critic = self.critic.get_latent(seen if self.copies else seen[: self._samples])
        values = st.values.flatten(0, 1)
        for rows, x in zip(
            values.split(self._size), critic[: self._samples].split(self._size), strict=True
        ):
            rows.copy_(self._critic.forward(x))
        super().compute_returns(obs)
        self._inputs = actor, critic, self._facts()

    def _facts(self) -> Tensor:
        """(B, 28), or (2 B, 28) with copies: action, mean, log-probability, A, V and R of each."""
        st = self.storage
        assert st.distribution_params is not None
        parts = (st.actions, st.distribution_params[0], st.actions_log_prob)
        parts = (*parts, st.advantages, st.values, st.returns)
        facts = torch.cat([part.flatten(0, 1) for part in parts], dim=1)
        if not self.copies:
            return facts
        actions = self._mirror(facts[:, :12])
        return torch.cat([facts, torch.cat([actions, facts[:, 12:]], dim=1)])

    def _mirror(self, actions: Tensor) -> Tensor:
        """(N, 12) actions as seen in the mirror."""
        both = cast(Any, self.symmetry).data_augmentation_func(env=None, obs=None, actions=actions)
        return both[1][len(actions) :]

    @torch.no_grad()
    def update(self) -> dict[str, float]:
        """Epochs over shuffled minibatches of the rollout; mean losses."""
        assert self._inputs is not None, "compute_returns comes first"
        self._attach()
        order = torch.randperm(self.num_mini_batches * self._size)
        losses: dict[str, Tensor] = {}
        for _ in range(self.num_learning_epochs):
            for rows in order.split(self._size):
                for name, value in self._learn(rows).items():
                    losses[name] = losses.get(name, 0.0) + value
        for model in (self.actor, self.critic):
            seen = [self.storage.observations[group] for group in model.obs_groups]
            follow(model.obs_normalizer, torch.cat(seen, dim=-1).flatten(0, 1))
        self.storage.clear()
        self._inputs = None
        count = self.num_learning_epochs * self.num_mini_batches
        return {name: float(value) / count for name, value in losses.items()}

    def _attach(self) -> None:
        """Make every gradient a piece of the one tensor: others may have let go of theirs."""
        at = 0
        for p in (*self.actor.parameters(), *self.critic.parameters()):
            p.grad = self._gradient[at : at + p.numel()].view_as(p)
            at += p.numel()

    def _learn(self, rows: Tensor) -> dict[str, Tensor]:
        """One step of the optimiser on some of the rollout's samples; the losses before it."""
        assert self._inputs is not None
        actor, critic, facts = self._inputs
        both = torch.cat([rows, rows + self._samples])
        reflected = both if self.copies or self.mirror_loss else rows
        learnt = both if self.copies else rows
        fact = facts.index_select(0, learnt)
        action, before, log_prob, advantage, v, target = fact.split([12, 12, 1, 1, 1, 1], dim=1)

        means = self._actor.forward(actor.index_select(0, reflected))
        mean = means[: len(learnt)]
        spread = cast(Any, self.actor.distribution).log_std_range
        log_std = self.log_std.clamp(*spread)
        std = log_std.exp()
        self._adapt(before[: len(rows)], mean[: len(rows)], std)
        z = (action - mean) / std
        # log p = −Σ (z²/2 + log σ + log √(2π)), so dlog p/dμ = z/σ and dlog p/dlog σ = z² − 1.
        now = -(0.5 * z.square()).sum(dim=1, keepdim=True) - log_std.sum() - 12 * _LOG_ROOT
        policy, slope = surrogate(now - log_prob, advantage, self.clip_param)
        entropy = (log_std + 0.5 + _LOG_ROOT).sum()
        gradient = torch.zeros_like(means)
        gradient[: len(learnt)] = slope * z / std
        free = (self.log_std >= spread[0]) & (self.log_std <= spread[1])
        assert self.log_std.grad is not None
        self.log_std.grad.copy_(free * ((slope * (z.square() - 1.0)).sum(0) - self.entropy_coef))
        losses = {"surrogate": policy, "entropy": entropy}
        if self.mirror_loss:
            gap = means[len(rows) :] - self._mirror(means[: len(rows)])
            losses["symmetry"] = gap.square().mean()
            weight = cast(Any, self.symmetry).mirror_loss_coeff
            gradient[len(rows) :] += 2.0 * weight / gap.numel() * gap
        self._actor.backward(gradient)

        x = self._critic.forward(critic.index_select(0, learnt))
        losses["value"], slope = value_loss(x, v, target, self.clip_param)
        self._critic.backward(self.value_loss_coef * slope)
        self._step()
        return losses

    def _step(self) -> None:
        if self.is_multi_gpu:
            distributed.all_reduce(self._gradient)
            self._gradient /= self.gpu_world_size
        for part in (self._gradient[: self._split], self._gradient[self._split :]):
            part.mul_((self.max_grad_norm / (part.norm() + 1e-6)).clamp(max=1.0))
        self.optimizer.step()

    def _adapt(self, before: Tensor, mean: Tensor, std: Tensor) -> None:
        """rsl-rl's rule: a third slower or faster where the policies' KL leaves what is desired."""
        if self.desired_kl is None or self.schedule != "adaptive":
            return
        assert self.storage.distribution_params is not None
        ratio = (self.storage.distribution_params[1][0, 0] / std).square()
        apart = ((before - mean) / std).square()
        kl = 0.5 * (apart + ratio - 1.0 - ratio.log()).sum(dim=1).mean()
        if self.is_multi_gpu:
            distributed.all_reduce(kl)
            kl /= self.gpu_world_size
            distributed.broadcast(kl, src=0)  # to the last bit: rates must not part
        if kl > 2.0 * self.desired_kl:
            self.learning_rate = max(1e-5, self.learning_rate / 1.5)
        elif 0.0 < kl < 0.5 * self.desired_kl:
            self.learning_rate = min(1e-2, self.learning_rate * 1.5)
        for group in self.optimizer.param_groups:
            group["lr"] = self.learning_rate
