"""The report as one HTML page: the paper's numbers beside ours, all in one file, never stale."""

import json
import re
import shutil
from pathlib import Path

import pytest

from studio.errors import StudioError
from studio.evaluation.markdown_tables import Shown, tables_of
from studio.evaluation.paper import CLAIMS, NOT_MEASURED, beside
from studio.evaluation.report import COMMITTED, PICTURES, Report, make
from studio.paths import package_folder

REPO = Path(__file__).parents[2]


def committed() -> list[Shown]:
    pages = [(package_folder("models") / name).read_text("utf-8") for name in COMMITTED]
    return [table for text in pages for table in tables_of(text)]


def test_the_tables_of_a_page_are_read_as_they_were_written() -> None:
    rows = "| a | b |\n|---|---|\n| 1 | 2 [1, 3] |\n| – | yes |\n"
    text = f"# Page\n\n## One\n\nWords.\n\n{rows}\n## Two\n"
    (table,) = tables_of(text)
    assert (table.heading, table.note, table.columns) == ("One", "Words.", ["a", "b"])
    assert table.rows == [["1", "2 [1, 3]"], ["–", "yes"]]


def test_each_of_the_papers_results_stands_beside_what_our_pages_say() -> None:
    tables = committed()
    for claim in CLAIMS:
        assert bool(claim.ours) != bool(claim.beyond), claim.what
        for figure in claim.ours:
            assert figure.read(tables), (claim.what, figure)
    said = {of: ours for of, _, ours in beside(tables)}
    scores = (package_folder("models") / "policy" / "SCORES.md").read_text("utf-8")
    ratio = re.search(r"\| policy \| 2\.1 \| 10\.7 \| ([\d.]+) \|", scores)
    assert ratio is not None
    assert said["Workspace of a front paw, standing"].startswith(f"{ratio[1]} times")


def test_what_no_page_says_is_not_made_up() -> None:
    assert {ours for _, _, ours in beside([])} == {
        NOT_MEASURED, *(claim.beyond for claim in CLAIMS if claim.beyond),
    }  # fmt: skip


def test_the_committed_report_is_of_the_pages_as_they_stand() -> None:
    data = json.loads((package_folder("models") / "report" / "index.json").read_text("utf-8"))
    again = "make it again: the first lines of studio/evaluation/report_html.py say how"
    assert data["tables"] == [table.as_dict() for table in committed()], again
    assert [tuple(row.values()) for row in data["paper"]] == list(beside(committed())), again


def test_the_page_needs_no_other_file(tmp_path: Path) -> None:
    sessions = tmp_path / "sessions"
    shutil.copytree(REPO / "sessions" / "example-cmu-march", sessions / "example-cmu-march")
    out = tmp_path / "report" / "index.html"
    replays = ("example-cmu-march",)
    made = make(Report(out=out, committed=True, sessions=sessions, replays=replays))
    assert made["tables"] == len(committed())
    text = out.read_text("utf-8")
    assert all(
        x.startswith("data:image/png;base64,") for x in re.findall(r'<img[^>]* src="([^"]*)', text)
    )
    assert text.count("<img ") == len(PICTURES)
    assert text.count("srcdoc=") == 1
    assert "<link" not in text
    assert not re.search(r"<(script|iframe)[^>]* src=", text)
    for link in re.findall(r'<a href="([^"#:]+)', text):
        assert (out.parent / link.partition("#")[0]).resolve().exists(), link


def test_tables_that_were_kept_make_a_page_that_says_how(tmp_path: Path) -> None:
    tables = tmp_path / "tables"
    (tables / "made").mkdir(parents=True)
    row = {
        "state": "stand", "controller": "policy", "seed": 7, "episodes": 64,
        "volume_m3": 0.002, "volume_tilt_m3": 0.006, "ratio": 3.0,
    }  # fmt: skip
    (tables / "workspace.json").write_text(json.dumps([row]))
    about = {"seconds": 7200.0, "cpu": "A processor", "cores": 2}
    (tables / "made" / "workspace.json").write_text(json.dumps(about))
    out = tmp_path / "report.html"
    make(Report(out=out, tables=tables))
    data = json.loads(out.with_suffix(".json").read_text("utf-8"))
    assert "A processor" in data["facts"]
    assert "seeds 7; 2.0 hours" in data["facts"]
    said = {row["of"]: row["measured"] for row in data["paper"]}
    assert said["Workspace of a front paw, standing"] == "3.00 times (2.0 → 6.0 litres)"
    assert said["Individual tasks: tilt, standing"] == NOT_MEASURED
    assert "<script>" not in out.read_text("utf-8")


def test_the_committed_pages_are_made_as_html_alone(tmp_path: Path) -> None:
    with pytest.raises(StudioError, match=r"ends in \.html"):
        make(Report(out=tmp_path / "page.md", committed=True))
