"""The operator beside real people: how much of their motion its own spans."""

import json
from pathlib import Path

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.clips import LABELS, clips_below, read_labels
from studio.evaluation.operator_plot import plot
from studio.evaluation.operator_ranges import Ranges, near
from studio.evaluation.operator_statistics import (
    operator_features,
    operator_statistics,
    real_features,
)


def test_coverage_is_the_shared_part_of_the_real_range():
    # real 0..2 against 1..5: half; against -1..3: all; against 4..5: nothing
    real = np.tile(np.array([[0.0], [2.0]]), (3, 1, 3))
    operator = np.tile(np.array([[1.0, -1.0, 4.0], [5.0, 3.0, 5.0]]), (3, 1, 1))
    coverage = Ranges(real=real, operator=operator, near=np.ones(3), frames=1).coverage
    assert np.allclose(coverage, [[0.5, 1.0, 0.0]] * 3)


def test_a_folder_without_labels_says_what_is_missing(tmp_path: Path):
    with pytest.raises(StudioError, match=r"labels\.json"):
        real_features(tmp_path)


def test_a_frame_is_near_when_all_its_joints_together_are():
    someone = np.zeros((3, 55))
    one_far, all_near = np.zeros(55), np.full(55, 0.1)
    one_far[0] = 2.0
    # 2 m in one coordinate of 18 joints are 0.47 m RMS; 0.1 m in all 55 are 0.17 m.
    assert near(np.stack([one_far, all_near]), someone, 0.2) == 0.5
    assert near(np.stack([one_far, all_near]), np.stack([one_far, all_near]), 0.01) == 1.0


def test_wide_people_cover_what_real_ones_were_seen_to_do():
    # The ranges only; with 24 people all shares are .9 or more (the shares of 3 vary by .05).
    seen = json.loads((Path(__file__).parent / "real_ranges.json").read_text())
    acted = operator_features(3, np.random.default_rng(4), "wide")
    for state, frames in acted.items():
        ranges = np.array([seen[state][order] for order in ("q", "qd", "qdd")])
        acting = np.moveaxis(np.percentile(frames, [5.0, 95.0], axis=1), 0, 1)
        found = Ranges(real=ranges, operator=acting, near=np.ones(3), frames=0)
        assert found.coverage.mean(axis=1).min() > 0.8, state


def test_labels_of_a_state_that_there_is_not_are_refused(tmp_path: Path):
    (tmp_path / "a.bvh").touch()
    labels = '{"a.bvh": [{"from": 0, "to": 1, "expert": "%s"}], "gone.bvh": []}'
    (tmp_path / LABELS).write_text(labels % "fly")
    with pytest.raises(StudioError, match="fly"):
        real_features(tmp_path)
    (tmp_path / LABELS).write_text(labels % "sit")
    assert list(read_labels(tmp_path)) == ["a.bvh"]
    assert clips_below(tmp_path) == [tmp_path / "a.bvh"]


@pytest.mark.slow
def test_the_operator_spans_most_of_what_real_people_do(clips: Path, tmp_path: Path):
    statistics = operator_statistics(real_features(clips), people=4, seed=1)
    share = {state: ranges.coverage.mean(axis=1) for state, ranges in statistics.items()}
    assert set(share) == {"stand", "walk", "sit"}
    assert min(share[state][0] for state in share) > 0.45
    assert share["walk"].min() > 0.6
    assert share["sit"].min() > 0.5
    plot({"default": statistics, "wide": statistics}, tmp_path / "figure.png")
    assert 30_000 < (tmp_path / "figure.png").stat().st_size < 300_000
