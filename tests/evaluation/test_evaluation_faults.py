"""A line that fails: what each kind of fault does to the frames, and what the table makes of it."""

from dataclasses import replace

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation import long_drive
from studio.evaluation.faults import RATES, Driven, FaultyLine, Options, drive_over, run_faults
from studio.synthetic.operator import OperatorSource
from studio.timing import CONTROL_DT


def through(kind: str, rate: float, seed: int = 3, seconds: float = 10.0):
    """The line at its end, the poses that came through, and who sent them."""
    line = FaultyLine(OperatorSource("walk", seed=1), kind, rate, seed)
    poses = [line.read(k * CONTROL_DT) for k in range(round(seconds / CONTROL_DT))]
    return line, poses


def test_a_good_line_brings_every_frame_in_its_period_as_it_was():
    line, poses = through("none", 0.0)
    clean = OperatorSource("walk", seed=1)
    for k, pose in enumerate(poses):
        sent = clean.read(k * CONTROL_DT)
        assert pose is not None
        assert sent is not None
        np.testing.assert_allclose(pose.joint_pos_w, sent.joint_pos_w, atol=1e-9)
    assert (line.sent, line.rejected) == (300, 0)


@pytest.mark.parametrize(
    ("kind", "rate", "missing", "refused"),
    [
        ("dropped", 0.3, (0.2, 0.4), (0.0, 0.0)),
        ("late", 0.2, (0.2, 0.8), (0.2, 0.7)),
        ("swapped", 0.3, (0.1, 0.4), (0.05, 0.35)),
        ("doubled", 0.5, (0.0, 0.01), (0.4, 0.6)),
        ("spoilt", 0.4, (0.1, 0.45), (0.1, 0.45)),
        ("silent", 0.4, (0.1, 0.8), (0.0, 0.0)),
    ],
)
def test_each_fault_takes_its_share_and_the_gate_refuses_what_it_should(
    kind, rate, missing, refused
):
    line, poses = through(kind, rate, seconds=20.0)
    share = np.mean([pose is None for pose in poses])
    assert missing[0] <= share <= missing[1]
    assert refused[0] <= line.rejected / line.sent <= refused[1]
    again, same = through(kind, rate, seconds=20.0)
    assert [pose is None for pose in same] == [pose is None for pose in poses]
    assert again.rejected == line.rejected


def test_a_row_is_all_people_of_a_kind_and_a_rate():
    asked = []

    def driven(kind, rate, options, seed):
        asked.append((kind, rate, seed))
        return Driven(falls=seed, followed=0.5 * seed, joint_sq=0.01, sent=10, refused=seed)

    rows = run_faults(Options(episodes=2, seconds=30.0, seed=1), drive=driven)["rows"]
    assert len(rows) == sum(len(rates) for rates in RATES.values())
    assert asked[:2] == [("none", 0.0, 1), ("none", 0.0, 2)]
    for row in rows:
        assert (row["falls"], row["seconds"]) == (3, 60.0)
        assert row["followed"] == pytest.approx(0.75)
        assert row["refused_share"] == pytest.approx(0.15)
        assert row["joint_rmse_deg"] == pytest.approx(np.degrees(0.1))


def test_somebody_over_a_bad_line_keeps_the_robot_up():
    options = Options(seconds=8.0, source="operator:tilt")
    for kind in ("none", "spoilt", "silent"):
        done = drive_over(kind, RATES[kind][-1], options, seed=5)
        assert done.falls == 0
        assert (done.followed > 0.95) == (kind == "none")


def test_a_fall_is_counted_and_the_robot_set_up_again(monkeypatch):
    monkeypatch.setattr(long_drive, "LIE_S", 0.5)
    options = Options(seconds=30.0, source="operator:walk", controller="pd_playback")
    assert drive_over("none", 0.0, options, seed=0).falls > 0


def test_options_that_make_no_table_are_refused():
    for bad in ("source", "bvh:x"), ("seconds", 0.0), ("episodes", 0):
        with pytest.raises(StudioError):
            replace(Options(), **{bad[0]: bad[1]})
