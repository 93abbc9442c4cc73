"""A policy is published only where it beats PD playback on every score."""

import json
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation import publish
from studio.evaluation.publish import SCORES, Publish


def rows(**policy: float) -> dict:
    playback = dict.fromkeys(SCORES, 0.5)
    return {
        "rows": [
            {"controller": "pd_playback", **playback},
            {"controller": "policy", **(playback | {"seed": 1} | policy)},
        ]
    }


@pytest.fixture
def run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    folder = tmp_path / "run"
    folder.mkdir()
    for name in ("policy.safetensors", "checkpoint.safetensors"):
        (folder / name).write_bytes(b"weights")
    (folder / "policy.json").write_text(json.dumps({"state": "walk", "scores": {}}))
    monkeypatch.setattr(publish, "MODELS", tmp_path / "models")
    return folder


BETTER = {name: 0.4 for name in SCORES} | {"success_time_ratio": 0.6, "tracked_time_ratio": 0.5}


def test_a_better_policy_is_kept_with_its_scores(
    run: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(publish, "run_tracking", lambda *a, **k: rows(**BETTER))
    publish.publish(Publish(state="walk", run=run, episodes=3))
    models = publish.MODELS
    assert (models / "walk.safetensors").read_bytes() == b"weights"
    assert (models / "checkpoints" / "walk.safetensors").exists()
    scores = json.loads((models / "walk.json").read_text())["scores"]
    assert scores["policy"] == BETTER
    assert scores["episodes"] == 3


@pytest.mark.parametrize("name", ["tracked_time_ratio", "foot_error_m"])
def test_a_policy_that_is_worse_anywhere_is_refused(
    run: Path, monkeypatch: pytest.MonkeyPatch, name: str
) -> None:
    worse = BETTER | {name: 0.45 if name == "tracked_time_ratio" else 0.55}
    monkeypatch.setattr(publish, "run_tracking", lambda *a, **k: rows(**worse))
    with pytest.raises(StudioError, match=name):
        publish.publish(Publish(state="walk", run=run))
    assert not publish.MODELS.exists()
