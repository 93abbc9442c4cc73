"""The tracking table: its rows, its cache, and that standing still does not win it."""

from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation.tracking import Options, run_tracking

FIGURES = (
    "success_time_ratio",
    "tracked_time_ratio",
    "joint_rmse_deg",
    "foot_error_m",
    "orientation_error_deg",
)


@pytest.mark.slow
def test_rows_carry_every_figure_with_its_interval_and_come_from_the_cache(tmp_path: Path) -> None:
    def make() -> dict:
        options = Options(
            episodes=4,
            seed=1,
            states=("sit",),
            controllers=("stand_still", "pd_playback"),
            threads=1,
        )
        return run_tracking(options, cache=tmp_path, progress=False)

    first = make()
    assert [(r["state"], r["controller"]) for r in first["rows"]] == [
        ("sit", "stand_still"),
        ("sit", "pd_playback"),
    ]
    for row in first["rows"]:
        assert (row["episodes"], row["seed"]) == (4, 1)
        for name in FIGURES:
            low, high = row[f"{name}_ci"]
            assert low <= row[name] <= high
    files = {f: f.stat().st_mtime_ns for f in tmp_path.glob("*.npz")}
    assert len(files) == 2
    assert make() == first
    assert {f: f.stat().st_mtime_ns for f in tmp_path.glob("*.npz")} == files


def test_unknown_names_list_the_known_ones() -> None:
    with pytest.raises(StudioError, match="pd_playback, policy, policy_true_future, stand_still"):
        run_tracking(Options(episodes=1, controllers=("juggle",)))
    with pytest.raises(StudioError, match="sit, stand, walk"):
        run_tracking(Options(episodes=1, states=("fly",)))  # type: ignore[arg-type]
    with pytest.raises(StudioError, match="--episodes"):
        run_tracking(Options(episodes=0))
