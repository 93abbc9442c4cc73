"""How late a camera's frame is: each section has its row; without a browser that is said."""

import math

import pytest

from studio.evaluation import browser
from studio.evaluation.latency import Options, run_latency


def test_without_a_browser_the_row_says_what_to_install(monkeypatch):
    monkeypatch.setattr(browser.shutil, "which", lambda _: None)
    (row,) = run_latency(Options())["rows"]
    assert row["case"] == "skipped"
    assert "install chromium" in row["why"]


@pytest.mark.long
@pytest.mark.browser
@pytest.mark.timeout(600)
def test_each_section_of_a_frame_s_way_has_its_percentiles():
    if browser.found() is None:
        pytest.skip(browser.MISSING)
    rows = {row["case"]: row for row in run_latency(Options(seconds=4.0))["rows"]}
    sections = ("camera", "model", "page", "way", "wait", "reference", "physics", "screen")
    assert tuple(rows) == (*sections, "to reference", "all", "film")
    for row in rows.values():
        assert 0.0 <= row["p50_ms"] <= row["p95_ms"] <= row["p99_ms"] < math.inf
        assert row["frames"] > 0
    # Of each frame the parts are all of it, and so no part's median is over the whole's.
    assert 0.0 < max(rows[name]["p50_ms"] for name in sections) < rows["all"]["p50_ms"]
