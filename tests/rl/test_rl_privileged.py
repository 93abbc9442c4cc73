"""What a teacher sees of the simulation, and its answers in a student's noisy environment."""

from pathlib import Path

import numpy as np
import pytest
from safetensors.numpy import save_file

from studio.errors import StudioError
from studio.rl.bank import MotionBank, build_bank
from studio.rl.curriculum import Curriculum, Rung
from studio.rl.env import ImitationEnv
from studio.rl.env_config import EnvConfig
from studio.rl.privileged import FULL_STATE_DIM, LearnedTeacher, PrivilegedEnv, full_state
from studio.rl.robots import PRIVILEGED_DIM


@pytest.fixture(scope="module")
def bank() -> MotionBank:
    return build_bank("sit", per_task=1, seconds=2.0, difficulties=(1.0,))


def environment(
    bank: MotionBank, kind: type[ImitationEnv] = ImitationEnv, noise: float = 1.0
) -> ImitationEnv:
    stage = Rung(tasks=bank.tasks, difficulty=1.0, randomisation=1.0)
    env = kind(
        EnvConfig(num_envs=4, threads=1, noise_scale=noise),
        bank,
        seed=3,
        curriculum=Curriculum(ladder=[stage]),
    )
    env.reset()
    return env


def constant_teacher(path: Path, action: float = 0.1) -> Path:
    """Weights of a teacher that always answers the same."""
    save_file(
        {
            "mean": np.zeros(FULL_STATE_DIM, np.float32),
            "std": np.ones(FULL_STATE_DIM, np.float32),
            "weight_0": np.zeros((12, FULL_STATE_DIM), np.float32),
            "bias_0": np.full(12, action, np.float32),
        },
        path,
    )
    return path


def test_the_full_state_knows_no_noise_of_the_reference(bank: MotionBank) -> None:
    """The same robots, the reference noisy or not: a teacher sees the same."""
    noisy, clean = environment(bank, noise=1.0), environment(bank, noise=0.0)
    assert np.abs(noisy.noisy_joint_pos - clean.noisy_joint_pos).max() > 0.02
    assert full_state(noisy) == pytest.approx(full_state(clean), abs=1e-6)


def test_the_full_state_tells_a_push_and_where_the_targets_are(bank: MotionBank) -> None:
    env = environment(bank)
    before = full_state(env)
    env.world.push(np.arange(4), np.tile([0.3, 0.0, 0.0], (4, 1)))
    env.world.target[:, 5] += 0.2
    changed = np.greater(np.abs(full_state(env) - before), 1e-6)
    assert changed[:, :2].any(axis=1).all()  # velocity, in the heading frame
    target = PRIVILEGED_DIM + 12 + 5 + 5
    assert set(np.flatnonzero(np.any(changed, axis=0))) - {0, 1, 2} == {target}


def test_a_teachers_environment_observes_the_full_state(bank: MotionBank) -> None:
    env = environment(bank, PrivilegedEnv, noise=0.0)
    seen = env.step(np.zeros((4, 12)))[0]
    assert seen.shape == (4, FULL_STATE_DIM)
    assert np.array_equal(seen, full_state(env))
    some = np.array([1, 3])
    assert np.array_equal(env.observation(some), seen[some])


def test_a_learned_teacher_answers_about_the_clean_reference(
    bank: MotionBank, tmp_path: Path
) -> None:
    """What the student should have done makes up for the noise that it saw."""
    env = environment(bank)
    answer = LearnedTeacher(constant_teacher(tmp_path / "teacher.safetensors"))(env)
    clean = bank.joint_pos[env.motion, env.frame]
    scale = env.config.action.scale
    assert env.noisy_joint_pos + scale * answer == pytest.approx(clean + scale * 0.1, abs=1e-6)


def test_what_is_no_teacher_is_refused(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="--privileged"):
        LearnedTeacher(tmp_path / "none.safetensors")
    save_file(
        {
            "mean": np.zeros(176, np.float32),
            "std": np.ones(176, np.float32),
            "weight_0": np.zeros((12, 176), np.float32),
            "bias_0": np.zeros(12, np.float32),
        },
        tmp_path / "policy.safetensors",
    )
    with pytest.raises(StudioError, match="176"):
        LearnedTeacher(tmp_path / "policy.safetensors")
