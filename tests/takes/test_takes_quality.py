"""Scores and maps against counts done by hand."""

import numpy as np
import pytest

from studio.takes.align.alignment import Alignment
from studio.takes.dataset import coverage, quality
from studio.takes.dataset.cleaning import Suggestion


def fault(kind, start, end, share=1.0):
    return Suggestion(kind=kind, start=start, end=end, share=share, message="")


def test_a_clean_take_in_time_scores_100():
    aligned = Alignment(lag=0.02, correlation=0.95, certainty=1.0)
    q = quality.quality(seconds=10.0, found=[], alignment=aligned, jerk_m_s3=20.0)
    assert q.score == 100.0
    assert q.reasons == ()


def test_reasons_add_up_to_what_is_missing_and_the_dearest_leads():
    found = [fault("jitter", 0.0, 1.0, 0.2), fault("limb_swap", 2.0, 4.0, 0.3)]
    q = quality.quality(seconds=10.0, found=found)
    # swap: 2 + 80 * 3 * (2 * .3 / 10) = 16.4; jitter: 2 + 50 * 3 * (1 * .2 / 10) = 5
    assert [r.name for r in q.reasons] == ["limb_swap", "jitter"]
    assert [r.points for r in q.reasons] == pytest.approx([16.4, 5.0])
    assert q.score == pytest.approx(100 - 21.4)


def test_a_fallen_robot_a_late_person_and_a_short_take_are_named():
    late = Alignment(lag=0.5, correlation=0.3, certainty=0.5)
    q = quality.quality(seconds=1.0, found=[], alignment=late, fallen_share=0.5, jerk_m_s3=240.0)
    assert {r.name for r in q.reasons} == {"fallen", "short", "disagree", "lag", "rough"}
    # 35 + 30 + 40 * (1 - .3 / .4) + 10 * .5 + 10 * log2(4) = 100
    assert sum(r.points for r in q.reasons) == pytest.approx(100.0)
    assert q.score == pytest.approx(0.0)


def test_jerk_of_a_cubic_is_its_third_derivative():
    t = np.arange(30) / 30.0
    pos = np.zeros((30, 1, 3))
    pos[:, 0, 0] = 2.0 * t**3  # third derivative 12
    assert quality.median_jerk(pos, 1 / 30) == pytest.approx(12.0, rel=1e-6)


def still(n, **over):
    base = {name: np.zeros(n) for name in ("roll", "pitch", "yaw", "speed", "turn")}
    return base | {"height": np.full(n, 0.27), "right paw": np.full(n, 0.02)} | {
        "left paw": np.full(n, 0.02)
    } | over  # fmt: skip


def test_map_counts_frames_per_bin_and_proposes_the_thinnest_task():
    rolls = np.linspace(-39.9, 39.9, 800)
    data = {"stand": [still(800, roll=rolls, pitch=rolls, yaw=rolls)]}
    found = coverage.coverage(data, 1 / 30)
    assert found.counts["stand"]["roll"].tolist() == [100] * 8
    assert found.counts["stand"]["right paw"].tolist() == [800, 0, 0, 0, 0]
    assert found.seconds["stand"] == pytest.approx(800 / 30)
    tasks = [task for task, _ in found.proposals]
    assert "manipulate_right" in tasks
    assert "tilt" not in tasks
    assert tasks.index("sit_manipulate") < tasks.index("manipulate_right")


def test_full_map_proposes_nothing_more():
    full = {}
    for state, axes in coverage.AXES.items():
        values = still(4000)
        for axis in axes:
            values[axis.name] = np.linspace(axis.edges[0], axis.edges[-1], 4000)
        full[state] = [values]
    found = coverage.coverage(full, 1 / 30)
    assert found.proposals == ()
    assert all(found.share(state) == 1.0 for state in full)


def test_speed_and_turn_are_read_off_the_path():
    n = 120
    t = np.arange(n) / 30
    yaw = 0.2 * t
    pos = np.stack([0.5 * t, 0 * t, np.full(n, 0.27)], axis=-1)
    quat = np.stack([np.cos(yaw / 2), 0 * t, 0 * t, np.sin(yaw / 2)], axis=-1)
    v = coverage.values("walk", pos, quat, np.tile([0, 0.9, -1.8], (n, 4)), 1 / 30)
    assert v["speed"][60] == pytest.approx(0.5)
    assert v["turn"][60] == pytest.approx(np.rad2deg(0.2))
