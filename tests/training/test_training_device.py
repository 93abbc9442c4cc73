"""Where networks learn: what there is, what there is not, and that a run can change places."""

from pathlib import Path

import pytest
import torch

from studio.errors import StudioError
from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.training.device import check_device, devices, threads
from studio.training.policy_settings import PolicyTraining
from studio.training.policy_trainer import PolicyTrainer
from studio.training.ppo import PpoConfig, TorchEnv, threads_to_act

SMALL = PpoConfig(horizon=6, epochs=1, minibatch=48, hidden=(32, 32))


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("sit", per_task=1, seconds=2.0, difficulties=(1.0,))


def environment(bank: MotionBank) -> ImitationEnv:
    stage = Rung(tasks=bank.tasks, difficulty=1.0, randomisation=1.0)
    config = EnvConfig(num_envs=16, threads=1)
    return ImitationEnv(config, bank, curriculum=Curriculum(ladder=[stage]))


def trainer(bank: MotionBank, device: str) -> PolicyTrainer:
    config = PolicyTraining(state="sit", num_envs=16, threads=1, ppo=SMALL, device=device)
    return PolicyTrainer(config, environment(bank))


@pytest.mark.parametrize("name", ["meta", "gpu", "cuda:99", "", "cpu:1"])
def test_a_device_that_is_not_there_is_refused_with_those_that_are(name: str) -> None:
    with pytest.raises(StudioError, match=r"no device .* have: cpu"):
        PolicyTraining(state="sit", device=name)


def test_every_device_that_is_listed_takes_a_tensor() -> None:
    assert devices()[0] == "cpu"
    for name in devices():
        check_device(name)
        assert torch.zeros(2, device=name).device.type == name.partition(":")[0]


def test_observations_and_their_mirror_lie_on_the_learners_device(bank: MotionBank) -> None:
    # "meta" computes nothing, but knows where a tensor lies: no GPU is needed for that.
    env = TorchEnv(environment(bank), "meta")
    env.env.reset()
    obs = env.present()
    both, actions = env.mirrored(env, obs, torch.zeros(16, 12, device="meta"))
    assert both is not None
    assert actions is not None
    for tensor in (obs["actor"], obs["privileged"], both["actor"], both["privileged"], actions):
        assert tensor.device.type == "meta"
    assert both["actor"].shape == (32, env.env.config.observation.dim)


@pytest.mark.skipif(devices() == ["cpu"], reason="torch finds no accelerator here")
def test_a_run_begun_on_an_accelerator_goes_on_on_the_processor(
    bank: MotionBank, tmp_path: Path
) -> None:
    first = trainer(bank, devices()[1])
    first.teach(2 * 16 * 24, lambda _: None)
    first.step()
    first.save(tmp_path / "checkpoint.safetensors")
    second = trainer(bank, "cpu")
    second.restore(tmp_path / "checkpoint.safetensors")
    for name, value in first.tensors().items():
        assert value == pytest.approx(second.tensors()[name])
    second.step()
    again = trainer(bank, devices()[1])
    again.restore(tmp_path / "checkpoint.safetensors")
    again.step()
    assert again.samples == second.samples


def test_acting_wakes_no_thread_that_does_not_pay() -> None:
    before = torch.get_num_threads()
    with threads(4):
        assert torch.get_num_threads() == 4
        assert [threads_to_act(n) for n in (2, 512, 2048, 100_000)] == [1, 1, 2, 4]
    assert torch.get_num_threads() == before
