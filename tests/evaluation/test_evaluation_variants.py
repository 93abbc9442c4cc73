"""The tables of second policies: the future's worth, the curriculum's, by the shipped weights."""

import json
import os
from pathlib import Path

import pytest

from studio.evaluation import curriculum as curriculum_table
from studio.evaluation import future as future_table
from studio.evaluation.curriculum import ROWS as CURRICULUM
from studio.evaluation.curriculum import run_curriculum
from studio.evaluation.future import ROWS as FUTURE
from studio.evaluation.future import run_future
from studio.training.variants import publish


@pytest.mark.slow
def test_the_future_and_the_curriculum_are_told_by_the_same_few_walks(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)  # banks are kept under runs/
    settings = {"cache": tmp_path / "rows", "progress": False}
    future = run_future(future_table.Options(episodes=3, threads=1), **settings)["rows"]  # type: ignore[arg-type]
    assert [row["variant"] for row in future] == list(FUTURE.values())
    assert [row["controller"] for row in future] == list(FUTURE)
    for row in future:
        assert (row["state"], row["episodes"], row["seed"]) == ("walk", 3, 0)
        assert 0.8 < row["success_time_ratio"] <= 1.0
        low, high = row["joint_rmse_deg_ci"]
        assert low <= row["joint_rmse_deg"] <= high
        # Everybody was asked to go the same way (a fall would cut it).
        assert row["path_m"] == pytest.approx(future[0]["path_m"], rel=0.2)
    by = {row["controller"]: row for row in future}
    # Who knows what comes next follows closer, and no later than it is asked.
    assert by["true_future"]["joint_rmse_deg"] < by["no_teacher"]["joint_rmse_deg"] - 0.5
    assert by["true_future"]["lag_ms"] < by["no_teacher"]["lag_ms"]

    curriculum = run_curriculum(curriculum_table.Options(episodes=3, threads=1), **settings)["rows"]  # type: ignore[arg-type]
    assert [row["variant"] for row in curriculum] == list(CURRICULUM.values())
    again = {row["controller"]: row for row in curriculum}
    assert list(again) == list(CURRICULUM)
    for name in ("no_teacher", "full"):  # the same walks, so the same figures
        assert {**again[name], "variant": ""} == {**by[name], "variant": ""}
    assert again["no_curriculum"]["joint_rmse_deg"] != again["no_teacher"]["joint_rmse_deg"]
    assert len(list((tmp_path / "rows").glob("*.npz"))) == 4


def test_variants_that_are_not_trained_have_no_rows(tmp_path: Path) -> None:
    assert run_future(future_table.Options(episodes=1), models=tmp_path) == {"rows": []}
    assert run_curriculum(curriculum_table.Options(episodes=1), models=tmp_path) == {"rows": []}


def test_a_variant_that_is_published_again_takes_the_place_of_the_older_one(tmp_path: Path) -> None:
    """Whoever reads the older one meanwhile has it whole: nothing is written into its files."""
    made, kept = tmp_path / "policy.safetensors", tmp_path / "walk-full.safetensors"
    older = []
    for content in (b"old", b"new"):
        made.write_bytes(content)
        made.with_suffix(".json").write_text(json.dumps({"samples": len(older)}))
        publish(made, kept, "full")
        for file in (kept, kept.with_suffix(".json")):
            older.append(file.with_name(f"{content.decode()}-{file.name}"))
            os.link(file, older[-1])
    assert [file.read_bytes() for file in (older[0], older[2])] == [b"old", b"new"]
    assert [json.loads(file.read_text())["samples"] for file in (older[1], older[3])] == [0, 2]
    assert len(list(tmp_path.iterdir())) == 8
