"""The page of scores: goals judged by the worst row, tables of what was made."""

import json
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation.report import Report, load, make, page


def walk_rows(achieved: float) -> list[dict[str, object]]:
    common = {"seed": 0, "episodes": 1, "drift_share": 0.04, "survived": True}
    speeds = {"commanded_m_s": 0.5, "commanded_deg_s": 0.0, "achieved_deg_s": 1.0}
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


def test_only_tables_that_were_made_are_on_the_page(tmp_path: Path) -> None:
    (tmp_path / "walk.json").write_text(json.dumps(walk_rows(0.4)))
    text = page(load(tmp_path), "facts")
    assert "evaluate walk" in text
    assert "evaluate tilt" not in text
    assert "| b | policy | 0.50 | 0.40 | 0.0 | 1.0 | 4 | yes |" in text


def test_an_unknown_table_is_answered_with_the_known_ones(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match="kicks"):
        make(Report(out=tmp_path / "page.md", tables="juggling", parts=tmp_path))


@pytest.mark.slow
def test_the_page_is_made_from_a_real_evaluation(tmp_path: Path) -> None:
    out = make(Report(out=tmp_path / "page.md", tables="reach", parts=tmp_path / "parts"))
    text = out.read_text()
    assert "| a paw sitting | ≥ 0.8 m |" in text
    assert "| sit | both | policy |" in text
