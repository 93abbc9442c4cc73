"""The teacher that cheats, and what a policy learns from it."""

import numpy as np
import pytest

from studio import geometry
from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.teacher import TeacherConfig, load_torque, teacher_action
from studio.robot import a1, kinematics
from studio.training.distil import DistilConfig, Distiller
from studio.training.policy_settings import PolicyTraining
from studio.training.ppo import PpoConfig, TorchEnv, make_algorithm


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("stand", per_task=1, seconds=2.0, difficulties=(0.4, 1.0))


def environment(bank: MotionBank, n: int, randomisation: float = 1.0) -> ImitationEnv:
    stage = Rung(tasks=bank.tasks, difficulty=1.0, randomisation=randomisation)
    config = EnvConfig(num_envs=n, threads=1)
    return ImitationEnv(config, bank, curriculum=Curriculum(ladder=[stage]))


def test_load_torques_do_the_work_of_lifting_the_trunk() -> None:
    """Virtual work: a small turn of the joints lifts the feet against their share of the weight."""
    q = a1.STAND_JOINT_POS[None] + 0.1 * np.random.default_rng(0).standard_normal((1, 12))
    quat = geometry.quat_from_rpy([0.2, -0.1, 0.5])[None]
    contact = np.array([[1.0, 0.0, 1.0, 1.0]])
    torque = load_torque(q, quat, contact)
    step = 1e-6 * np.random.default_rng(1).standard_normal((1, 12))
    before, after = (kinematics.foot_pos_w(np.zeros(3), quat, x) for x in (q - step, q + step))
    raised = (after - before)[0, :, 2] / 2.0
    # The floor pushes each foot up with f; motors do −f · dz: feet down is trunk up.
    work = -np.sum(contact[0] / 3.0 * a1.TOTAL_MASS * 9.81 * raised)
    assert float(torque[0] @ step[0]) == pytest.approx(work, rel=1e-5)


def test_the_teacher_cancels_the_noise_of_the_reference(bank: MotionBank) -> None:
    env = environment(bank, 4)
    env.reset()
    action = teacher_action(env, TeacherConfig(lead=0, sag=0.0))
    clean = bank.joint_pos[env.motion, env.frame]
    assert env.noisy_joint_pos + 0.25 * action == pytest.approx(clean)
    assert np.abs(env.noisy_joint_pos - clean).max() > 0.02


def test_the_teacher_looks_ahead(bank: MotionBank) -> None:
    env = environment(bank, 4)
    env.reset()
    action = teacher_action(env, TeacherConfig(lead=3, sag=0.0))
    ahead = bank.joint_pos[env.motion, np.minimum(env.frame + 3, bank.frames - 1)]
    assert env.noisy_joint_pos + 0.25 * action == pytest.approx(ahead)


@pytest.mark.slow
def test_lessons_bring_the_student_closer_to_the_teacher(bank: MotionBank) -> None:
    env = environment(bank, 32)
    env.reset()
    alg = make_algorithm(TorchEnv(env), PpoConfig(hidden=(64, 64)))
    distiller = Distiller(alg, env, DistilConfig(horizon=8, passes=16, minibatch=128))
    losses = [distiller.lesson(k / 12)["imitation_loss"] for k in range(12)]
    assert np.mean(losses[-3:]) < 0.5 * losses[0]


def test_only_the_default_preset_has_a_teacher() -> None:
    assert PolicyTraining(state="walk").lessons > 0
    assert PolicyTraining(state="sit").lessons == 0
    assert PolicyTraining(state="walk", preset="paper").lessons == 0
    assert PolicyTraining(state="sit", distil=5).lessons == 5
