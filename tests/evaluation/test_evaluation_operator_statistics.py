"""The operator beside real people: how much of their motion its own spans."""

from pathlib import Path

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation.clips import LABELS, clips_below, read_labels
from studio.evaluation.operator_statistics import Ranges, operator_statistics, plot


def test_coverage_is_the_shared_part_of_the_real_range():
    # real 0..2 against 1..5: half; against -1..3: all; against 4..5: nothing
    real = np.tile(np.array([[0.0], [2.0]]), (3, 1, 3))
    operator = np.tile(np.array([[1.0, -1.0, 4.0], [5.0, 3.0, 5.0]]), (3, 1, 1))
    coverage = Ranges(real=real, operator=operator, frames=1).coverage
    assert np.allclose(coverage, [[0.5, 1.0, 0.0]] * 3)


def test_a_folder_without_labels_says_what_is_missing(tmp_path: Path):
    with pytest.raises(StudioError, match=r"labels\.json"):
        operator_statistics(tmp_path)


def test_labels_of_a_state_that_there_is_not_are_refused(tmp_path: Path):
    (tmp_path / "a.bvh").touch()
    labels = '{"a.bvh": [{"from": 0, "to": 1, "expert": "%s"}], "gone.bvh": []}'
    (tmp_path / LABELS).write_text(labels % "fly")
    with pytest.raises(StudioError, match="fly"):
        operator_statistics(tmp_path)
    (tmp_path / LABELS).write_text(labels % "sit")
    assert list(read_labels(tmp_path)) == ["a.bvh"]
    assert clips_below(tmp_path) == [tmp_path / "a.bvh"]


@pytest.mark.slow
def test_the_operator_spans_most_of_what_real_people_do(clips: Path, tmp_path: Path):
    statistics = operator_statistics(clips, people=4, seed=1)
    share = {state: ranges.coverage.mean(axis=1) for state, ranges in statistics.items()}
    assert set(share) == {"stand", "walk", "sit"}
    assert min(share[state][0] for state in share) > 0.45
    assert share["walk"].min() > 0.6
    assert share["sit"].min() > 0.5
    plot(statistics, tmp_path / "figure.png")
    assert 30_000 < (tmp_path / "figure.png").stat().st_size < 300_000
