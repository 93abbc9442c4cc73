"""The shipped policies act live as they were trained to: one robot's path beside the batch's."""

from functools import cache

import numpy as np
import pytest
import torch

from studio.control.action import clip_action, pd_target
from studio.control.policy import MODELS, Policy
from studio.reference.intent import StateName
from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.noise import NoiseConfig
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotState
from studio.training.ppo import TorchEnv

QUIET = NoiseConfig(joint_sigma=(0.0, 0.0), repeat=(0.0, 0.0), encoder=0.0, gyro=0.0)
SHIPPED = ("stand", "walk", "sit")
OTHERS = ("ablation/walk-absolute_action",)


@cache
def motions(state: StateName) -> MotionBank:
    return build_bank(state, per_task=1, seconds=2.5, difficulties=(1.0,))


def environment(policy: Policy) -> ImitationEnv:
    """One robot as the policy was trained on, without noise: live there is none to compare."""
    bank = motions(policy.manifest["state"])
    config = EnvConfig(
        num_envs=1,
        threads=1,
        noise=QUIET,
        observation=policy.observation,
        action=policy.action_config,
    )
    stage = Rung(tasks=bank.tasks, difficulty=1.0, randomisation=0.0)
    curriculum = Curriculum(ladder=[stage])
    return ImitationEnv(config, bank, seed=1, curriculum=curriculum)


def trained_action(policy: Policy, env: TorchEnv) -> np.ndarray:
    """(1, 12): the learner's network in torch; a symmetric one is averaged with its mirror image
    as the learner mirrors its batches."""
    layers = policy.layers

    def network(x: torch.Tensor) -> torch.Tensor:
        x = (x - torch.from_numpy(layers.mean)) * torch.from_numpy(layers.scale)
        for i, (weight, bias) in enumerate(zip(layers.weights, layers.biases, strict=True)):
            x = x @ torch.from_numpy(weight) + torch.from_numpy(bias)
            x = torch.relu(x) if i + 1 < len(layers.weights) else x
        return x

    if not policy.manifest.get("symmetric", False):
        return network(env.present()["actor"]).numpy()
    both, _ = env.mirrored(env, env.present(), None)
    assert both is not None
    here, there = network(both["actor"])
    _, back = env.mirrored(env, None, there[None])
    assert back is not None
    return (0.5 * (here + back[1]))[None].numpy()


def live_poses(env: ImitationEnv, step: int) -> tuple[ReferencePose, RobotState]:
    """What the live flow would hand the policy in the environment's present period."""
    bank, w, at = env.bank, env.world, (env.motion[0], env.frame[0])
    feet = kinematics.foot_pos_w(w.base_pos[0], w.base_quat[0], w.joint_pos[0])
    reference = ReferencePose(
        base_pos=bank.base_pos[at],
        base_quat=bank.base_quat[at],
        joint_pos=bank.joint_pos[at],
        foot_contact=bank.contact[at],
        base_lin_vel_w=bank.lin_vel_w[at],
        base_ang_vel_b=bank.ang_vel_b[at],
        joint_vel=bank.joint_vel[at],
    )
    robot = RobotState(
        base_pos=np.array(w.base_pos[0]),
        base_quat=np.array(w.base_quat[0]),
        joint_pos=np.array(w.joint_pos[0]),
        foot_contact=np.ones(4),
        t=step * a1.CONTROL_DT,
        base_lin_vel_w=np.array(w.base_lin_vel_w[0]),
        base_ang_vel_b=np.array(w.base_ang_vel_b[0]),
        joint_vel=np.array(w.joint_vel[0]),
        foot_pos_w=feet,
        torque=np.zeros(12),
    )
    return reference, robot


@pytest.mark.parametrize("name", SHIPPED + OTHERS)
def test_a_shipped_policy_acts_live_as_in_training(name: str) -> None:
    policy = Policy.load(MODELS / f"{name}.safetensors")
    env = environment(policy)
    env.reset()
    learner = TorchEnv(env)
    steps, missed = 0, 0.0
    for step in range(45):
        reference, robot = live_poses(env, step)
        if step == 0:
            policy.reset(reference, robot)
        action = clip_action(trained_action(policy, learner).astype(np.float64))
        trained = pd_target(action, env.noisy_joint_pos, env.neutral, policy.action_config)[0]
        np.testing.assert_allclose(policy.action(reference, robot), trained, atol=1e-5)
        steps = step
        missed = max(missed, float(np.abs(env.history.heading_error).max()))
        np.testing.assert_allclose(
            policy.history.heading_error, env.history.heading_error, atol=1e-9
        )
        _, _, terminated, truncated, _ = env.step(action)
        if terminated.any() or truncated.any():
            break
    assert steps > 20
    assert np.abs(action).max() > 0.05  # it did act
    assert (missed > 1e-3) == (policy.observation.heading_gain > 0.0)


def test_the_shipped_policies_hold_and_mirror_as_their_sidecars_say() -> None:
    """What the test above is to cover is there: held headings, symmetric weights."""
    facts = {name: Policy.load(name) for name in SHIPPED}
    assert facts["walk"].observation.heading_gain > 0.0
    assert any(p.manifest.get("symmetric", False) for p in facts.values())
