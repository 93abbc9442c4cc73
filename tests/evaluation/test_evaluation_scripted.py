"""Scripted motions at nominal dynamics: the tables of tilt and walking speed."""

from pathlib import Path

import numpy as np
import pytest

from studio.evaluation import scripted, tilt, walk, workspace
from studio.reference.tracks import make_track


@pytest.fixture(autouse=True)
def _playback_alone(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(scripted, "MODELS", tmp_path)


def test_standing_playback_tilts_as_far_as_it_is_asked() -> None:
    length = 75
    asked = np.zeros((length, 3))
    asked[:, 0] = np.radians(15.0) * np.minimum(np.arange(length) / 30.0, 1.0)
    done = scripted.record(
        "stand", [make_track("stand", "tilt", length, tilt=asked)], "pd_playback"
    )
    assert done.alive.all()
    assert done.base_quat.shape == (length - 1, 1, 4)
    # A roll of 15 degrees: q = (cos 7.5°, sin 7.5°, 0, 0)
    assert np.degrees(2.0 * np.arcsin(done.base_quat[-1, 0, 1])) == pytest.approx(15.0, abs=2.0)


@pytest.mark.slow
def test_tilt_has_a_row_for_each_state_axis_and_side() -> None:
    rows = tilt.run_tilt()["rows"]
    assert len(rows) == 2 * 3 * 2
    stand = [r for r in rows if r["state"] == "stand"]
    assert {abs(r["commanded_deg"]) for r in stand} == {40.0}
    for row in stand:
        assert row["survived"]
        assert np.sign(row["achieved_deg"]) == np.sign(row["commanded_deg"])


@pytest.mark.slow
def test_walk_rows_compare_commanded_with_achieved() -> None:
    rows = walk.run_walk()["rows"]
    marched = [row for row in rows if row["means"] == "march"]
    for row, (speed, turn) in zip(marched, walk.CASES, strict=True):
        assert row["commanded_m_s"] == pytest.approx(speed, abs=0.04)
        assert row["commanded_deg_s"] == pytest.approx(turn, abs=1.0)
    fastest = next(r for r in rows if r["case"] == "0.97 m/s, 0 deg/s")
    assert fastest["achieved_m_s"] > 0.3
    spatial = [row for row in rows if row["means"] == "through space"]
    for row, (ahead, left, turn) in zip(spatial, walk.THROUGH_SPACE, strict=True):
        assert row["commanded_m_s"] == pytest.approx(ahead, abs=0.02)
        assert row["commanded_side_m_s"] == pytest.approx(left, abs=0.02)
        assert row["commanded_deg_s"] == pytest.approx(turn, abs=1.0)
        assert (row["drift_share"] is None) == (turn != 0.0)
    to_the_left = next(r for r in spatial if r["case"] == "0 and 0.3 m/s, 0 deg/s")
    assert to_the_left["achieved_side_m_s"] > 0.0


def test_voxels_count_each_cube_once() -> None:
    points = np.array([[0.001, 0.0, 0.0], [0.019, 0.01, 0.01], [0.021, 0.0, 0.0], [-0.001, 0, 0]])
    assert workspace.voxel_volume(points, 0.02) == pytest.approx(3 * 8e-6)


@pytest.mark.slow
def test_tilting_widens_the_workspace() -> None:
    (row,) = workspace.run_workspace(workspace.Options(episodes=8))["rows"]
    assert row["ratio"] > 1.2
    assert row["volume_m3"] > 0.0
