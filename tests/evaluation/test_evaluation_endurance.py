"""Minutes of driving: falls are counted and stood up from, with an honest interval."""

import numpy as np
import pytest

from studio.errors import StudioError
from studio.evaluation import endurance as en
from studio.evaluation.impaired import IMPAIRMENTS, Impaired, Impairment
from studio.synthetic.operator import OperatorSource

DT = 1.0 / 30.0


def test_the_interval_is_poissons():
    # None in 6,000 s: 2 t / chi2(.975, 2) = 12000 / 7.3778; three: 12000 / 17.5345, / 1.2373.
    assert en.time_between(0, 6000.0)[0] == pytest.approx(1626.5, abs=0.5)
    assert en.time_between(0, 6000.0)[1] is None
    low, high = en.time_between(3, 6000.0)
    assert low == pytest.approx(684.4, abs=0.5)
    assert high == pytest.approx(9698.0, rel=2e-3)


def test_a_window_of_walking_tells_what_was_asked_and_the_way_made():
    steps = [(True, 0.5, np.array([0.4 * k * DT, 0.0])) for k in range(2 * en.WINDOW + 1)]
    asked, made = en._windows(steps)
    assert asked == pytest.approx((0.5, 0.5))
    assert made == pytest.approx((0.4, 0.4))
    steps[5] = (False, 0.5, steps[5][2])  # a stand in between: that window is no walk
    assert len(en._windows(steps)[0]) == 1


def test_a_person_walks_for_a_while_and_the_row_says_how_fast():
    run = en.endure(en.Case(source="operator:walk"), 101, 12.0)
    row = en.row(en.Case(source="operator:walk"), [run], 0)
    assert (row["falls"], row["seconds"]) == (0, 12.0)
    assert row["mean_time_between_falls_s"] is None
    assert row["speed_asked_m_s"] > 0.2
    assert row["speed_made_m_s"] > 0.7 * row["speed_asked_m_s"]


@pytest.mark.slow
def test_who_falls_lies_for_three_seconds_is_stood_up_and_goes_on():
    case = en.Case(source="operator:walk", controller="pd_playback", dynamics="table_i")
    runs = [en.endure(case, 100 + k, 40.0) for k in range(6)]
    falls = [t for run in runs for t in run.falls]
    assert len(falls) >= 2  # PD playback does not walk long on such robots
    again = [b - a for run in runs for a, b in zip(run.falls, run.falls[1:])]
    assert all(gap > en.LIE_S for gap in again)
    row = en.row(case, runs, 0)
    assert row["seconds"] == pytest.approx(240.0 - 3.0 * len(falls))


def test_no_case_left_says_which_there_are():
    with pytest.raises(StudioError, match="operator:walk"):
        en.run_endurance(en.Options(source="bvh:x"))


def arrivals(impairment, seconds=20.0, seed=3):
    source = Impaired(OperatorSource("walk", seed=1), impairment, seed)
    clean = OperatorSource("walk", seed=1)
    out = []
    for k in range(round(seconds / DT)):
        out.append((k * DT, clean.read(k * DT), source.read(k * DT)))
    return out


def test_what_is_impaired_by_nothing_arrives_as_it_was():
    for _, clean, seen in arrivals(Impairment(), seconds=2.0):
        np.testing.assert_array_equal(clean.joint_pos_w, seen.joint_pos_w)


def test_frames_are_late_lost_and_mistaken_as_asked():
    how = Impairment(delay=(0.010, 0.060), drop=0.1, gaps=0.5, glitches=1.0)
    rows = arrivals(how)
    late = [t - seen.t for t, _, seen in rows if seen is not None]
    assert min(late) >= 0.010 - 1e-9
    assert max(late) <= 0.060 + 2 * DT
    share = len(late) / len(rows)
    assert 0.5 < share < 0.95
    true = {round(clean.t, 6): clean for _, clean, _ in rows}
    far = [
        np.abs(seen.joint_pos_w - true[round(seen.t, 6)].joint_pos_w).max()
        for _, _, seen in rows
        if seen is not None
    ]
    assert 0.0 < np.mean(np.array(far) > 0.05) < 0.3
    twice = arrivals(how)
    assert [s is None for *_, s in rows] == [s is None for *_, s in twice]


def test_every_impairment_can_be_watched():
    for name, how in IMPAIRMENTS.items():
        source = en._source(en.Case(sensor=name), 100)
        assert source.calibration_poses()
        assert any(source.read(k * DT) is not None for k in range(10)), how
