"""How late the robot is, frame by frame, in a real Chromium whose camera shows a numbered film."""

import math
from itertools import pairwise

import pytest
from browsing import FLAGS, chromium, click, until

from studio.synthetic.film import FPS, film

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]

NO_GRAPHICS = [flag for flag in FLAGS if "swiftshader" in flag]
FAKE = ("--disable-gpu", "--use-fake-device-for-media-stream")
SECONDS = 4.0
SECTIONS = ("camera", "model", "page", "way", "wait", "reference", "physics", "screen")


def test_each_frame_is_echoed_in_order_and_its_sections_add_up(served, tmp_path):
    video = film(tmp_path / "a.mjpeg", ("quiet", SECONDS))
    own = (*FAKE, f"--use-file-for-fake-video-capture={video}")
    with (
        chromium(*own, without=NO_GRAPHICS) as browsing,
        browsing.page(served, 900, 640, path="/camera", permissions=["camera"]) as page,
    ):
        click(page, "#start")
        until(page, "() => a1camera.seen?.world")
        page.evaluate(
            "() => { for (const d of document.querySelectorAll('details')) d.open = true; }"
        )
        click(page, "#drive")
        until(page, "() => a1camera.latency.meter?.rows.length >= 30")
        rows = page.evaluate("() => a1camera.latency.meter.rows")
        shown = until(page, "() => document.querySelector('#latency table')?.innerText")
        page.evaluate("() => { document.querySelector('#latency').open = false; }")
        until(page, "() => !a1camera.latency.meter && !document.querySelector('#latency table')")
    assert browsing.problems == []
    for row in rows:
        assert all(math.isfinite(row[name]) and row[name] >= 0.0 for name in SECTIONS), row
        assert sum(row[name] for name in SECTIONS) == pytest.approx(row["total"], abs=1e-6)
        assert row["model"] > 0.0
        assert row["screen"] > 0.0
    codes = [row["code"] for row in rows]
    length = round(SECONDS * FPS)
    assert all(code is not None and 0 <= code < length for code in codes), codes
    # Each is newer than the one before, and what was skipped is less than a play of the film.
    for before, after in pairwise(rows):
        frames = (after["code"] - before["code"]) % length
        assert 0 < frames < length / 2, codes
    assert "p99" in shown
    assert "pose model" in shown
