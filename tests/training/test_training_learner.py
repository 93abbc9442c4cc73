"""Our PPO against rsl-rl's on the same rollout, and its gradients against autograd's."""

import copy
from typing import Any

import pytest
import torch
from rsl_rl.algorithms import PPO
from rsl_rl.modules import EmpiricalNormalization

from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Stage
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.training.device import threads
from studio.training.layers import Layers
from studio.training.learner import Learner, follow, surrogate, value_loss
from studio.training.ppo import PpoConfig, TorchEnv, collect, make_algorithm, threads_to_act

HORIZON = 12


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("sit", per_task=1, seconds=2.0, difficulties=(0.4, 1.0))


def with_rollout(bank: MotionBank, ppo: PpoConfig) -> tuple[Learner, TorchEnv, Any]:
    torch.manual_seed(0)
    stage = Stage(tasks=bank.tasks, difficulty=1.0, randomisation=0.5)
    settings = EnvConfig(num_envs=16, threads=1)
    env = TorchEnv(ImitationEnv(settings, bank, curriculum=Curriculum(ladder=[stage])))
    env.env.reset()
    alg = make_algorithm(env, ppo)
    assert isinstance(alg, Learner)
    alg.train_mode()
    obs, _ = collect(alg, env, env.present(), HORIZON)
    alg.update()  # a normaliser that does something, an optimiser that remembers
    with torch.no_grad():
        alg.log_std[1] = 0.0  # held at its limit, where nothing pulls
    obs, _ = collect(alg, env, obs, HORIZON)
    return alg, env, obs


def rsl_rl_of(alg: Learner) -> PPO:
    """rsl-rl's own algorithm in the same state."""
    other = PPO(
        copy.deepcopy(alg.actor),
        copy.deepcopy(alg.critic),
        copy.deepcopy(alg.storage),
        num_learning_epochs=alg.num_learning_epochs,
        num_mini_batches=alg.num_mini_batches,
        clip_param=alg.clip_param,
        gamma=alg.gamma,
        lam=alg.lam,
        entropy_coef=alg.entropy_coef,
        learning_rate=alg.learning_rate,
        max_grad_norm=alg.max_grad_norm,
        schedule=alg.schedule,
        desired_kl=alg.desired_kl,  # type: ignore[arg-type]
    )
    other.symmetry = alg.symmetry
    other.optimizer.load_state_dict(copy.deepcopy(alg.optimizer.state_dict()))
    return other


@pytest.mark.parametrize(
    "settings",
    [
        {"mirror": False},
        {"mirror": True},
        {"mirror": False, "mirror_loss": 1.0},
        {"mirror": True, "mirror_loss": 0.7},
        {"mirror": False, "desired_kl": None, "max_grad_norm": 0.1},
    ],
    ids=["plain", "copies", "mirror loss", "both", "fixed rate"],
)
def test_an_update_is_rsl_rls_update(bank: MotionBank, settings: dict[str, Any]) -> None:
    figures = {"horizon": HORIZON, "epochs": 3, "minibatch": 48, "hidden": (32, 24)}
    ppo = PpoConfig(**{**figures, "learning_rate": 2e-3, "entropy": 0.01, **settings})
    alg, _, _ = with_rollout(bank, ppo)
    other = rsl_rl_of(alg)
    before = copy.deepcopy(alg.actor.state_dict())
    torch.manual_seed(3)  # the same minibatches
    ours = alg.update()
    torch.manual_seed(3)
    theirs = other.update()
    for name, value in ours.items():
        assert value == pytest.approx(theirs[name], rel=1e-4, abs=1e-6), name
    assert alg.learning_rate == other.learning_rate
    for mine, reference in ((alg.actor, other.actor), (alg.critic, other.critic)):
        for name, value in reference.state_dict().items():
            assert torch.allclose(mine.state_dict()[name], value, atol=1e-5), name
    moved = alg.actor.state_dict()["mlp.0.weight"] - before["mlp.0.weight"]
    assert float(moved.abs().max()) > 1e-4


def test_values_of_the_whole_rollout_are_those_of_each_step(bank: MotionBank) -> None:
    ppo = PpoConfig(horizon=HORIZON, minibatch=48, hidden=(32, 24), mirror=False)
    alg, _, obs = with_rollout(bank, ppo)
    other = rsl_rl_of(alg)
    with torch.inference_mode():
        for seen, value in zip(alg.storage.observations, alg.storage.values, strict=True):
            assert torch.allclose(alg.critic(seen), value, atol=1e-5)
        other.compute_returns(obs)
    assert torch.allclose(alg.storage.returns, other.storage.returns, atol=1e-5)
    assert torch.allclose(alg.storage.advantages, other.storage.advantages, atol=1e-5)


def test_layers_give_the_networks_output_and_autograds_gradients() -> None:
    torch.manual_seed(0)
    network = torch.nn.Sequential(
        torch.nn.Linear(5, 7), torch.nn.ReLU(), torch.nn.Linear(7, 6), torch.nn.ReLU()
    )
    network.append(torch.nn.Linear(6, 2))
    x, slope = torch.randn(9, 5), torch.randn(9, 2)
    expected = network(x)
    expected.backward(slope)
    gradients = [p.grad.clone() for p in network.parameters() if p.grad is not None]
    layers = Layers(network, rows=12)  # room for more than come
    with torch.no_grad():
        assert torch.allclose(layers.forward(x), expected, atol=1e-6)
        layers.backward(slope)
    for parameter, gradient in zip(network.parameters(), gradients, strict=True):
        assert torch.allclose(parameter.grad, gradient, atol=1e-6)  # type: ignore[arg-type]


def test_the_surrogate_stops_where_the_clip_holds_it() -> None:
    # r = 1.5 and 0.5 past ±0.2, A = +1 and −1 in turn; only what makes things worse still pulls.
    ratio = torch.tensor([[1.5], [1.5], [0.5], [0.5], [1.1]])
    advantage = torch.tensor([[1.0], [-1.0], [1.0], [-1.0], [2.0]])
    loss, slope = surrogate(ratio.log(), advantage, 0.2)
    # −1.2, 1.5, −0.5, 0.8, −2.2
    assert float(loss) == pytest.approx((-1.2 + 1.5 - 0.5 + 0.8 - 2.2) / 5.0)
    assert slope[:, 0].tolist() == pytest.approx([0.0, 1.5 / 5, -0.5 / 5, 0.0, -2.2 / 5])


def test_a_value_is_not_pulled_on_once_it_has_moved_past_the_clip() -> None:
    # From 0: to 0.1 (free); to 1 with target 2, which the clipped 0.2 is farther from (held);
    # to 1 with target 0, itself the worse (pulled back).
    value = torch.tensor([[0.1], [1.0], [1.0]])
    target = torch.tensor([[1.0], [2.0], [0.0]])
    loss, slope = value_loss(value, torch.zeros(3, 1), target, 0.2)
    assert float(loss) == pytest.approx((0.9**2 + 1.8**2 + 1.0) / 3.0)
    assert slope[:, 0].tolist() == pytest.approx([-1.8 / 3, 0.0, 2.0 / 3])


def test_the_normaliser_follows_as_rsl_rls() -> None:
    torch.manual_seed(0)
    ours, theirs = EmpiricalNormalization(3), EmpiricalNormalization(3)
    for size in (4, 50):
        x = 5.0 + torch.randn(size, 3) * torch.tensor([0.1, 1.0, 10.0])
        follow(ours, x)
        theirs.update(x)
    for name, value in theirs.state_dict().items():
        assert torch.allclose(ours.state_dict()[name], value, rtol=1e-5), name


def test_acting_wakes_no_thread_that_does_not_pay() -> None:
    before = torch.get_num_threads()
    with threads(4):
        assert torch.get_num_threads() == 4
        assert [threads_to_act(n) for n in (2, 512, 2048, 100_000)] == [1, 1, 2, 4]
    assert torch.get_num_threads() == before
