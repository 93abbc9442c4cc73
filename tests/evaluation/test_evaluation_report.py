"""The page of scores: goals judged by the worst row, tables of what was made."""

import json
import os
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation.registry import run_table, table
from studio.evaluation.report import Report, _episodes, load, make, page


def walk_rows(achieved: float) -> list[dict[str, object]]:
    common = {"seed": 0, "episodes": 1, "drift_share": 0.04, "survived": True}
    speeds = {
        "means": "march", "commanded_m_s": 0.5, "commanded_deg_s": 0.0, "achieved_deg_s": 1.0,
        "commanded_side_m_s": 0.0, "achieved_side_m_s": 0.02,
    }  # fmt: skip
    return [
        {"case": "a", "controller": "pd_playback", "achieved_m_s": 0.1, **speeds, **common},
        {"case": "a", "controller": "policy", "achieved_m_s": 0.5, **speeds, **common},
        {"case": "b", "controller": "policy", "achieved_m_s": achieved, **speeds, **common},
    ]


@pytest.mark.parametrize(("achieved", "verdict"), [(0.45, "yes"), (0.3, "**no**")])
def test_a_goal_is_judged_by_the_policys_worst_row(achieved: float, verdict: str) -> None:
    text = page({"walk": walk_rows(achieved)}, "facts")
    line = next(x for x in text.splitlines() if x.startswith("| speeds"))
    # the baseline's 0.4 m/s does not count
    off = f"{abs(0.5 - achieved):.3g} m/s"
    assert line == f"| speeds 0 to 0.97 m/s, off by | ≤ 0.1 m/s | {off} | {verdict} |"
    assert "| drift, of the way | ≤ 5 % | 4 % | yes |" in text


def goal(text: str, words: str) -> list[str]:
    """Goal, figure and verdict of the one line that begins so."""
    (line,) = [x for x in text.splitlines() if x.startswith(f"| {words}")]
    return [cell.strip() for cell in line.split("|")[2:-1]]


def tilt_rows(state: str, axis: str, held: tuple[float, float], asked: float, **more: object):
    common = {"state": state, "axis": axis, "controller": "policy", "survived": True}
    return [
        # the reference is of a library that cannot ask for more: what was commanded counts
        {**common, "commanded_deg": c, "reference_deg": h, "achieved_deg": h, **more}
        for c, h in zip((-asked, asked), held, strict=True)
    ]


def test_a_sitting_tilt_is_judged_by_its_range_on_each_axis() -> None:
    rows = [
        *tilt_rows("sit", "pitch", (-20.0, 8.0), 15.0),  # its middle is off, its range is not
        *tilt_rows("sit", "roll", (7.5, -7.5), 7.5),  # the wrong way
        *tilt_rows("sit", "yaw", (0.0, 0.0), 3.5),  # stands still
    ]
    text = page({"tilt": rows}, "facts")
    assert goal(text, "sit pitch, 30°") == ["≤ 4°", "2°", "yes"]
    assert goal(text, "sit roll, 15°") == ["≤ 4°", "30°", "**no**"]
    assert goal(text, "sit yaw, 7°") == ["≤ 3.5°", "7°", "**no**"]


def test_a_standing_tilt_is_judged_by_what_was_commanded() -> None:
    text = page({"tilt": tilt_rows("stand", "yaw", (-40.0, 30.0), 40.0)}, "facts")
    assert goal(text, "stand ±40°") == ["≤ 4°", "10°", "**no**"]


def test_who_fell_has_not_met_the_goal() -> None:
    tilts = tilt_rows("stand", "yaw", (-40.0, 40.0), 40.0, survived=False)
    reach = [{"state": "sit", "controller": "policy", "paw_m": 0.9, "survived": False}]
    walk = [{**row, "survived": False} for row in walk_rows(0.5)]
    text = page({"tilt": tilts, "reach": reach, "walk": walk}, "facts")
    assert goal(text, "stand ±40°") == ["≤ 4°", "0°, fell", "**no**"]
    assert goal(text, "a paw sitting") == ["≥ 0.8 m", "0.9 m, fell", "**no**"]
    assert goal(text, "speeds") == ["≤ 0.1 m/s", "0 m/s, fell", "**no**"]


def tracking_row(controller: str, state: str = "walk", **changed: tuple[float, float, float]):
    figures = {
        "success_time_ratio": (0.995, 0.99, 0.999),
        "tracked_time_ratio": (0.8, 0.79, 0.81),
        "joint_rmse_deg": (4.0, 3.9, 4.1),
        "foot_error_m": (0.03, 0.029, 0.031),
        "orientation_error_deg": (2.0, 1.9, 2.1),
        "velocity_error_m_s": (0.1, 0.09, 0.11),
        **changed,
    }
    row: dict[str, object] = {"state": state, "controller": controller}
    for key, (value, low, high) in figures.items():
        row |= {key: value, f"{key}_ci": [low, high]}
    return row


def test_a_policy_beats_pd_playback_only_by_more_than_both_intervals() -> None:
    policy = tracking_row(
        "policy",
        success_time_ratio=(0.992, 0.985, 0.996),  # PD's is full: enough not to be worse
        tracked_time_ratio=(0.82, 0.805, 0.83),  # the intervals meet
        joint_rmse_deg=(3.0, 2.9, 3.1),
        foot_error_m=(0.0295, 0.0285, 0.0305),
        velocity_error_m_s=(0.2, 0.19, 0.21),
    )
    text = page({"tracking": [tracking_row("pd_playback"), policy]}, "facts")
    verdicts = {
        "success": ["not below 0.995 [0.990, 0.999]", "0.992 [0.985, 0.996]", "yes"],
        "tracked": ["above 0.800 [0.790, 0.810]", "0.820 [0.805, 0.830]", "**no**"],
        "joints °": ["below 4.0 [3.9, 4.1]", "3.0 [2.9, 3.1]", "yes"],
        "feet cm": ["below 3.0 [2.9, 3.1]", "2.9 [2.9, 3.0]", "**no**"],
        "velocity m/s": ["below 0.100 [0.090, 0.110]", "0.200 [0.190, 0.210]", "**no**"],
    }
    for words, cells in verdicts.items():
        assert goal(text, f"walk against PD: {words}") == cells
    assert "stand against PD" not in text
    assert "| walk | policy | 0.992 [0.985, 0.996] |" in text  # the table's cell


def test_a_policy_that_is_worse_where_pd_is_full_misses() -> None:
    policy = tracking_row(
        "policy",
        "sit",
        success_time_ratio=(0.98, 0.97, 0.989),
        velocity_error_m_s=(0.05, 0.04, 0.06),
    )
    text = page({"tracking": [tracking_row("pd_playback", "sit"), policy]}, "facts")
    assert goal(text, "sit against PD: success")[2] == "**no**"
    assert goal(text, "sit against PD: velocity m/s")[2] == "yes"  # a still state is judged too


def test_a_way_into_a_state_is_judged_by_whom_the_controller_lets_do_it() -> None:
    way = {"from": "stand", "to": "sit", "state": "sit"}
    rows = [
        {**way, "controller": "pd_playback", "in_charge": True, "success_time_ratio": 0.45},
        {**way, "controller": "policy", "in_charge": False, "success_time_ratio": 0.99},
    ]
    text = page({"transitions": rows}, "facts")
    assert goal(text, "from stand to sit, success") == ["≥ 0.95", "0.45", "**no**"]


def test_only_tables_that_were_made_are_on_the_page(tmp_path: Path) -> None:
    (tmp_path / "walk.json").write_text(json.dumps(walk_rows(0.4)))
    text = page(load(tmp_path), "facts")
    assert "evaluate walk" in text
    assert "evaluate tilt" not in text
    assert "| b | policy | 0.50 | 0.40 | 0.00 | 0.02 | 0.0 | 1.0 | 4 | yes |" in text


def test_a_table_without_columns_of_its_own_shows_every_figure_of_its_rows(tmp_path: Path) -> None:
    rows = [{"case": "operator", "seed": 0, "episodes": 2, "falls": 3, "first_falls_s": [1.0]}]
    (tmp_path / "styles.json").write_text(json.dumps(rows))
    text = page(load(tmp_path), "facts")
    assert "## Styles" in text
    assert "| case | falls |\n|---|---|\n| operator | 3.000 |" in text


def test_without_a_table_the_page_says_what_makes_them(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="a1-studio evaluate all"):
        make(Report(out=tmp_path / "page.md", tables=tmp_path))


@pytest.mark.slow
def test_the_page_is_made_from_a_real_evaluation(tmp_path: Path) -> None:
    run_table("reach", table("reach").options(), keep=tmp_path / "tables")
    made = make(Report(out=tmp_path / "page.md", tables=tmp_path / "tables"))
    assert made["tables"] == ["reach"]
    text = (tmp_path / "page.md").read_text()
    assert "| a paw sitting | ≥ 0.8 m |" in text
    assert "| sit | both | policy |" in text


def test_rows_of_unlike_numbers_of_episodes_say_so():
    rows = [{"state": "stand", "controller": "policy", "episodes": n} for n in (5120, 1024)]
    assert _episodes(rows) == "1024 to 5120 episodes a row"
    assert _episodes(rows[:1]) == "5120 episodes a row"
    assert _episodes([{"episodes": 1}]) == "one episode a case"


def test_a_page_made_anew_takes_the_place_of_the_older_one(tmp_path: Path) -> None:
    (tmp_path / "walk.json").write_text(json.dumps(walk_rows(0.45)))
    out, older = tmp_path / "pages" / "report.md", tmp_path / "older.md"
    make(Report(out=out, tables=tmp_path))
    os.link(out, older)  # somebody reads it meanwhile
    before = older.read_text()
    (tmp_path / "walk.json").write_text(json.dumps(walk_rows(0.3)))
    make(Report(out=out, tables=tmp_path))
    assert older.read_text() == before
    assert out.read_text() != before
