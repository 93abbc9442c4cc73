"""Plots in a real Chromium: asked beside done, live and of a take under review."""

import csv

import numpy as np
import pytest
from axe import find_nothing
from browsing import click, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

TAKE = "example-tilt-and-reach"
LEGEND = """() => [...document.querySelectorAll('#plot .u-legend .u-value')]
  .map((value) => value.textContent)"""
LINE = """() => {
  const line = document.querySelector('#plot .plot-now');
  return line.hidden ? null : parseFloat(line.style.left) / line.parentElement.clientWidth;
}"""
"""Where the line at the time shown is, from 0 to 1."""


@pytest.fixture(scope="module")
def served(example_sessions):
    """A studio with the two example takes."""
    served = Served(example_sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture
def live(page, served):
    """Live, no take on the bench, the plots closed."""
    served.client.post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live' && !document.body.dataset.reviewing")
    page.evaluate("() => { document.querySelector('#plots').open = false; }")
    return page


def opened(page) -> None:
    page.keyboard.press("j")
    until(page, "() => document.querySelector('#plot canvas')")


def reviewed(page) -> None:
    """The example take on the bench."""
    click(page, '#mode [data-mode="collect"]')
    click(page, f"#collected li[data-name={TAKE}] button")
    until(
        page, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )


def test_asked_and_done_are_plotted_and_taken_away(live, served):
    served.client.post("/api/source", json={"source": "operator:tilt"})
    opened(live)
    live.select_option("#plot-what", "roll")
    served.wait(lambda s: any(abs(t["reference"]["base_quat"][1]) > 0.05
                              for t in [*served.ticks.values()]))  # fmt: skip
    live.wait_for_timeout(3000)
    click(live, "#plot-freeze")
    find_nothing(live)
    with live.expect_download() as download:
        click(live, "#plot-csv")
    rows = download.value.path().read_text().splitlines()
    names = rows[0].split(",")
    assert names[:3] == ["t_s", "speed_asked_m_s", "speed_done_m_s"]
    values = np.array([[float(v or "nan") for v in row.split(",")] for row in rows[1:]])
    assert len(values) > 10
    assert np.isfinite(values[:, :-1]).all()
    asked, done = (values[:, names.index(f"roll_{who}_deg")] for who in ("asked", "done"))
    assert np.abs(asked - done).max() < 25.0
    with live.expect_download() as download:
        click(live, "#plot-png")
    assert download.value.path().read_bytes()[:4] == b"\x89PNG"
    click(live, "#plot-freeze")


def test_a_take_under_review_is_plotted_and_plot_and_timeline_go_to_the_same_time(
    live, served, tmp_path
):
    reviewed(live)
    seconds = served.client.get(f"/api/takes/{TAKE}/series").json()["seconds"]
    served.client.post("/api/seek", json={"t": seconds / 5, "playing": False})
    opened(live)
    # Where the take is, from the first drawing on.
    until(live, f"() => Math.abs(({LINE})() - 0.2) < 0.01 && !({LEGEND})().includes('–')")
    live.select_option("#plot-what", "roll")
    live.wait_for_timeout(500)
    assert "–" not in live.evaluate(LEGEND)
    box = live.locator("#plot .u-over").bounding_box()
    # The plot is pressed: the take goes there, and the line with it.
    live.mouse.click(box["x"] + 0.5 * box["width"], box["y"] + 40)
    until(live, f"() => Math.abs(a1studio.state.replay.t - {seconds / 2}) < 0.1")
    assert not live.evaluate("() => a1studio.state.replay.playing")
    until(live, f"() => Math.abs(({LINE})() - 0.5) < 0.01")
    # The pointer says values with their units.
    live.mouse.move(box["x"] + 0.25 * box["width"], box["y"] + 40)
    until(live, f"() => Math.abs(parseFloat(({LEGEND})()[0]) - {seconds / 4}) < 0.1")
    time, asked, done = live.evaluate(LEGEND)
    assert time.endswith(" s")
    assert asked.endswith(" °")
    assert done.endswith(" °")
    # The timeline is moved: the plot's line, and the values where nothing is pointed at, too.
    live.mouse.move(5, 5)
    live.focus("#timeline")
    live.keyboard.press("Home")
    until(live, f"() => ({LINE})() < 0.01 && parseFloat(({LEGEND})()[0]) < 0.1")
    live.keyboard.press("End")
    until(live, f"() => ({LINE})() > 0.99")
    with live.expect_download() as download:
        click(live, "#plot-csv")
    assert download.value.suggested_filename == f"{TAKE}-signals.csv"
    download.value.save_as(tmp_path / "signals.csv")
    with (tmp_path / "signals.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == round(30 * seconds)
    assert max(float(row["roll_asked_deg"]) for row in rows) > 5.0
    assert rows[0]["joints_late_ms"] == ""
    with live.expect_download() as download:
        click(live, "#plot-png")
    assert download.value.path().read_bytes()[:4] == b"\x89PNG"
    find_nothing(live)
    click(live, "#bench-close")
    # Live again: the last 20 s, and nothing of the take.
    until(live, f"() => ({LINE})() === null")
    assert not live.evaluate("() => document.querySelector('#plot-freeze').hidden")


def test_a_take_that_cannot_be_plotted_says_why(live, served, browsing):
    reviewed(live)
    tape = served.sessions / TAKE / "tape.mcap"
    whole = tape.read_bytes()
    tape.write_bytes(b"")
    try:
        with browsing.expecting("422"):
            live.keyboard.press("j")
            until(live, "() => !document.querySelector('#plot-error').hidden")
        said = live.inner_text("#plot-error")
        assert TAKE in said
        assert "no tick" in said
        assert not live.query_selector("#plot canvas")
        assert live.is_disabled("#plot-csv")
        tape.write_bytes(whole[: len(whole) // 2])
        live.keyboard.press("j")
        live.keyboard.press("j")
        until(live, "() => document.querySelector('#plot canvas')")
        assert live.inner_text("#plot-error").startswith("The take ends early: ")
    finally:
        tape.write_bytes(whole)
    click(live, "#bench-close")
