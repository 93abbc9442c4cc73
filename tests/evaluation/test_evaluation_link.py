"""The table of links: rows say what was sent over what, and what the robot made of it."""

import pytest

from studio.errors import StudioError
from studio.evaluation import link
from studio.evaluation.link import TOUR, Case, Options, Run, drive_over, row, run_link


def test_a_row_says_shares_over_people_and_leaves_out_what_is_none_of_its_task():
    runs = [
        Run(seconds=10.0, fell=True, done=False, lag=3, joint_ms=0.01, tilt=0.1, idle=0.0),
        Run(seconds=40.0, fell=False, done=True, lag=5, joint_ms=0.03, tilt=0.3, idle=0.2),
    ]
    tour = row(Case(level="references", delay_ms=100.0), runs, Options())
    assert tour["case"] == "references, tour"
    assert tour["success_time_ratio"] == pytest.approx((10 / 40 + 1) / 2)
    assert (tour["falls"], tour["done"], tour["delay_ms"]) == (1, None, 100.0)
    assert tour["lag_ms"] == pytest.approx(4 * 1000 / 30)
    assert tour["joint_rmse_deg"] == pytest.approx(8.103, abs=1e-3)  # sqrt(0.02) rad
    scene = row(Case(level="references", task="push"), runs, Options())
    assert (scene["done"], scene["success_time_ratio"]) == (0.5, None)
    assert scene["done_ci"][0] < 0.5 < scene["done_ci"][1]


def test_a_table_has_a_row_a_case_of_the_level_asked_for(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(link, "CASES", (Case(level="targets"), Case(level="references")))
    rows = run_link(Options(episodes=1, seconds=1.0, threads=1, level="targets"), cache=None)
    (only,) = rows["rows"]
    assert (only["level"], only["task"], only["falls"]) == ("targets", TOUR, 0)
    with pytest.raises(StudioError, match="seconds"):
        run_link(Options(seconds=0.0))


@pytest.mark.slow
def test_a_delay_goes_into_the_feedback_of_targets_and_not_of_references():
    late = 150.0
    assert drive_over(Case(level="targets", delay_ms=late), 20.0, 100).fell
    run = drive_over(Case(level="references", delay_ms=late), 20.0, 100)
    assert not run.fell
    assert run.lag >= 4
