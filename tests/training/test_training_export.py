"""An exported policy, run without this package, sends the targets that ours sends."""

import importlib.util
import itertools
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from studio.control.action import ActionConfig
from studio.control.observation import ObservationConfig
from studio.control.policy import Policy, manifest_of, save_policy
from studio.errors import StudioError
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotState
from studio.sim.actuation import LowPass, limit_target
from studio.training.export import export_onnx

REPO = Path(__file__).resolve().parents[2]


HOLDING = ObservationConfig(heading_gain=1.0, heading_smooth=0.5)


@pytest.fixture
def weights(tmp_path: Path) -> Path:
    return save_random(tmp_path, ObservationConfig())


def save_random(tmp_path: Path, observation: ObservationConfig, *, symmetric: bool = False) -> Path:
    rng = np.random.default_rng(0)
    sizes = (observation.dim, 64, 64, 12)
    tensors = {"mean": rng.standard_normal(sizes[0]), "std": rng.uniform(0.5, 2.0, sizes[0])}
    for i, (a, b) in enumerate(itertools.pairwise(sizes)):
        tensors[f"weight_{i}"] = rng.standard_normal((b, a)) / np.sqrt(a)
        tensors[f"bias_{i}"] = 0.1 * rng.standard_normal(b)
    neutral = NEUTRAL["stand"]
    manifest = manifest_of(
        "stand",
        observation,
        ActionConfig(),
        neutral.base_quat,
        neutral.joint_pos,
        seed=0,
        symmetric=symmetric,
    )
    path = tmp_path / "stand.safetensors"
    save_policy(path, {k: v.astype(np.float32) for k, v in tensors.items()}, manifest)
    return path


def runner_class() -> type:
    """As whoever copies the file would import it."""
    path = REPO / "models" / "policy" / "onnx_runner.py"
    spec = importlib.util.spec_from_file_location("onnx_runner", path)
    assert spec is not None
    assert spec.loader is not None
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.Runner


def poses(rng: np.random.Generator, t: int) -> tuple[ReferencePose, RobotState]:
    neutral = NEUTRAL["stand"]
    common: Any = {"base_pos": neutral.base_pos, "base_quat": neutral.base_quat}
    reference = ReferencePose(
        joint_pos=neutral.joint_pos + 0.2 * np.sin(0.2 * t + np.arange(12)),
        foot_contact=np.ones(4),
        base_lin_vel_w=rng.standard_normal(3),
        base_ang_vel_b=rng.standard_normal(3),
        **common,
    )
    robot = RobotState(
        joint_pos=neutral.joint_pos + 0.1 * rng.standard_normal(12),
        foot_contact=np.roll([1.0, 0.0, 0.0, 1.0], t // 5),
        t=t / 30.0,
        base_lin_vel_w=np.zeros(3),
        base_ang_vel_b=rng.standard_normal(3),
        joint_vel=np.zeros(12),
        foot_pos_w=np.zeros((4, 3)),
        torque=np.zeros(12),
        **common,
    )
    return reference, robot


@pytest.mark.parametrize("symmetric", [False, True])
@pytest.mark.parametrize("observation", [ObservationConfig(), HOLDING])
def test_onnx_and_its_runner_reproduce_the_targets(
    observation: ObservationConfig, symmetric: bool, tmp_path: Path
) -> None:
    weights = save_random(tmp_path, observation, symmetric=symmetric)
    runner = runner_class()(str(export_onnx(weights, tmp_path / "stand.onnx")))
    policy, lowpass = Policy.load(weights), LowPass()
    rng = np.random.default_rng(1)
    worst = 0.0
    for t in range(40):
        reference, robot = poses(rng, t)
        z, p = policy._frames(reference, robot)
        if t == 0:
            policy.reset(reference, robot)
            lowpass.reset(robot.joint_pos)
            runner.reset(z[0], p[0])
        ours = limit_target(lowpass.step(policy.action(reference, robot)))
        worst = max(worst, float(np.abs(ours - runner.step(z[0], p[0])).max()))
    assert worst < 1e-5


def test_the_file_says_what_it_needs(weights: Path, tmp_path: Path) -> None:
    manifest = runner_class()(str(export_onnx(weights, tmp_path / "stand.onnx"))).manifest
    assert manifest["joints"] == list(a1.JOINTS)
    assert (manifest["kp"], manifest["kd"], manifest["control_hz"]) == (a1.KP, a1.KD, 30.0)
    assert sum(block["size"] for block in manifest["observation_blocks"]) == 176
    assert manifest["filter"]["cutoff_hz"] == 5.0


def test_the_runner_needs_neither_studio_nor_many_lines() -> None:
    text = (REPO / "models" / "policy" / "onnx_runner.py").read_text()
    assert "studio" not in text
    code = [line for line in text.split('"""', 2)[2].splitlines() if line.strip()]
    assert len(code) <= 45


def test_a_policy_that_is_given_its_future_is_not_exported(tmp_path: Path) -> None:
    weights = save_random(tmp_path, ObservationConfig(future=(3,)))
    with pytest.raises(StudioError, match="future"):
        export_onnx(weights, tmp_path / "x.onnx")


def test_a_policy_that_is_not_there_names_those_that_are(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="train policy"):
        export_onnx("dance", tmp_path / "x.onnx")


def test_damaged_weights_are_refused(weights: Path) -> None:
    weights.write_bytes(b"nonsense")
    with pytest.raises(StudioError, match="cannot be read"):
        Policy.load(weights)
