"""`train policy` from end to end: what a run leaves, and that it goes on where it stopped."""

import json
from dataclasses import replace
from pathlib import Path

import pytest
import torch
from rsl_rl.algorithms import PPO
from tensorboard.backend.event_processing.event_accumulator import EventAccumulator

from studio.control.policy import Policy
from studio.errors import StudioError
from studio.training import checkpoint
from studio.training.device import threads
from studio.training.policy_settings import PolicyTraining
from studio.training.ppo import PpoConfig
from studio.training.train_policy import run_train_policy

EACH = 4 * 6
"""Samples an iteration: robots times control periods."""


@pytest.fixture
def settings(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> PolicyTraining:
    monkeypatch.chdir(tmp_path)  # banks are kept under runs/
    return PolicyTraining(
        state="sit",
        samples=3 * EACH,
        num_envs=4,
        motions_per_task=1,
        transitions=0,
        people=0,
        distil=0,
        run=Path("runs/tiny"),
        checkpoint_seconds=0.0,
        ppo=PpoConfig(horizon=6, epochs=1, minibatch=12, hidden=(8, 8)),
    )


def written(folder: Path, name: str) -> list[int]:
    """Sample counts at which TensorBoard was given a figure."""
    events = EventAccumulator(str(folder))
    events.Reload()
    return [event.step for event in events.Scalars(name)]


def facts(folder: Path) -> dict:
    return checkpoint.load(folder / "checkpoint.safetensors")[1]


@pytest.mark.slow
def test_a_run_leaves_weights_checkpoint_curve_and_figures_and_is_resumed(
    settings: PolicyTraining,
) -> None:
    folder = settings.folder
    first = run_train_policy(settings)
    assert (first["state"], first["samples"], first["run"]) == ("sit", 3 * EACH, str(folder))
    assert first["seconds"] > 0.0
    assert written(folder, "reward") == [EACH, 2 * EACH, 3 * EACH]
    assert json.loads(json.dumps(first)) == first  # what --json prints
    # A point of the curve at every checkpoint: here each iteration, and the end.
    curve = [point["samples"] for point in facts(folder)["curve"]]
    assert curve == [EACH, 2 * EACH, 3 * EACH, 3 * EACH]
    policy = Policy.load(folder / "policy.safetensors")
    assert policy.manifest["samples"] == 3 * EACH
    assert policy.manifest["machine"]["device"] == "cpu"

    on = run_train_policy(replace(settings, resume=True, samples=5 * EACH))
    assert on["samples"] == 5 * EACH
    assert on["seconds"] > first["seconds"]
    assert facts(folder)["iteration"] == 5
    assert written(folder, "reward") == [EACH * k for k in range(1, 6)]
    assert [p["samples"] for p in facts(folder)["curve"]] == [*curve, 4 * EACH, 5 * EACH, 5 * EACH]

    # Nothing is left to do: the run stays as it is.
    assert run_train_policy(replace(settings, resume=True))["samples"] == 5 * EACH


@pytest.mark.slow
def test_checkpoints_wait_for_their_interval_and_hours_end_a_run(settings: PolicyTraining) -> None:
    patient = replace(settings, checkpoint_seconds=3600.0, distil=2 * 4 * 24, samples=10**9)
    done = run_train_policy(replace(patient, hours=1.0 / 3600.0))
    assert 2 * 4 * 24 <= done["samples"] < 10**9
    steps = written(patient.folder, "teacher/imitation_loss")
    assert steps == [4 * 24, 2 * 4 * 24]
    # After the lessons and at the end, whatever the interval.
    assert [p["samples"] for p in facts(patient.folder)["curve"]] == [192, done["samples"]]


def test_going_on_from_a_run_that_never_was_says_how_to_start(settings: PolicyTraining) -> None:
    with pytest.raises(StudioError, match="without --resume"):
        run_train_policy(replace(settings, resume=True))


@pytest.mark.slow
def test_a_run_learns_on_every_core_that_is_its_own(
    settings: PolicyTraining, monkeypatch: pytest.MonkeyPatch
) -> None:
    seen: list[int] = []
    update = PPO.update

    def watched(self: PPO) -> dict[str, float]:
        seen.append(torch.get_num_threads())
        return update(self)

    monkeypatch.setattr(PPO, "update", watched)
    monkeypatch.setattr("studio.training.parallel.cores", lambda: 6)
    with threads(1):  # as the command line has it
        run_train_policy(settings)
        monkeypatch.setenv("LOCAL_WORLD_SIZE", "2")
        run_train_policy(replace(settings, run=Path("runs/shared"), samples=EACH))
        run_train_policy(replace(settings, run=Path("runs/told"), samples=EACH, threads=2))
        assert torch.get_num_threads() == 1
    assert seen == [6, 6, 6, 3, 2]
