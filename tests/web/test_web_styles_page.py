"""What the page colours and how it scrolls, in a real browser with our content policy."""

import numpy as np
import pytest
from acted_takes import acted_take, record
from browsing import click, drawn, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]

SCORES = {"poor": 0.5, "good": 1.0}
"""As edits keep them; the colour runs from bad (50 and below) to good (100)."""


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A studio with two takes that have a score."""
    sessions = tmp_path_factory.mktemp("root") / "sessions"
    acted = acted_take("tilt", np.random.default_rng(0), lag=0.3, seconds=4.0)
    for name in SCORES:
        record(acted, sessions, name, keep=True)
    served = Served(sessions, "--source", "operator:quiet")
    for name, score in SCORES.items():
        assert served.client.patch(f"/api/takes/{name}", json={"score": score}).status_code == 200
    yield served
    status, said = served.close()
    assert status == 0, said


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, collecting."""
    with browsing.page(served, 1300, 800) as page:
        click(drawn(page), '#mode [data-mode="collect"]')
        until(page, "() => document.querySelectorAll('.bins i').length > 0")
        yield page


STYLE = """([selector, property]) => [...document.querySelectorAll(selector)].map(
  (node) => getComputedStyle(node)[property])"""
# The red, green and blue of a colour however it is written, oklab(…) included.
PAINTED = """(colours) => colours.map((colour) => {
  const pen = document.createElement('canvas').getContext('2d');
  pen.fillStyle = colour;
  pen.fillRect(0, 0, 1, 1);
  return [...pen.getImageData(0, 0, 1, 1).data.slice(0, 3)];
})"""
THEME = """(names) => names.map((name) =>
  getComputedStyle(document.documentElement).getPropertyValue(name))"""


def test_scores_and_covered_bins_have_their_colours(page, served):
    until(page, "() => document.querySelectorAll('#collected em.score').length === 2")
    names = page.evaluate(
        "() => [...document.querySelectorAll('#collected li')].map((li) => li.dataset.name)"
    )
    colours = page.evaluate(PAINTED, page.evaluate(STYLE, ["#collected em.score", "color"]))
    worst, best = page.evaluate(PAINTED, page.evaluate(THEME, ["--bad", "--good"]))
    shown = dict(zip(names, colours, strict=True))
    np.testing.assert_allclose(shown["poor"], worst, atol=1)  # a colour is a whole number
    np.testing.assert_allclose(shown["good"], best, atol=1)

    # A bin is painted the more the fuller it is; an empty one is only outlined.
    enough = served.client.get("/api/collect/map").json()["enough"]
    titles = page.evaluate("() => [...document.querySelectorAll('.bins i')].map((i) => i.title)")
    frames = np.array([int(title.split(": ")[1].split()[0]) for title in titles])
    outlined = np.array(page.evaluate(STYLE, [".bins i", "outlineStyle"])) == "dashed"
    np.testing.assert_array_equal(outlined, frames == 0)
    assert 0 < outlined.sum() < len(outlined)
    painted = page.evaluate(PAINTED, page.evaluate(STYLE, [".bins i", "backgroundColor"]))
    full, empty = np.array(page.evaluate(PAINTED, page.evaluate(THEME, ["--accent", "--raised"])))
    share = np.minimum(1.0, np.round(frames / enough, 2))[:, None]
    expected = np.where(outlined[:, None], 0.0, share * full + (1 - share) * empty)
    np.testing.assert_allclose(painted, expected, atol=1)


@pytest.mark.parametrize("reached", ["by a click", "by the Tab key"])
def test_a_file_input_in_a_scrolled_panel_leaves_the_page_where_it_is(page, reached):
    """The input is invisible; the browser brings it into view when it gets the focus."""
    page.evaluate("() => document.querySelector('#keys-drive').focus()")
    page.evaluate("() => { document.querySelector('.panels').scrollTop = 1e6; }")
    if reached == "by a click":
        with page.expect_file_chooser():
            page.click("#dropzone")
    else:
        page.keyboard.press("Tab")
    assert page.evaluate("() => document.activeElement.id") == "file"
    scrolled = page.evaluate(
        "() => [document.documentElement.scrollTop, document.body.scrollTop, scrollX]"
    )
    assert scrolled == [0, 0, 0]
    stop = page.evaluate("() => document.querySelector('#stop').getBoundingClientRect().bottom")
    assert stop <= 800
    # Nothing lies below the page that anything else could scroll to.
    assert page.evaluate("() => document.documentElement.scrollHeight") == 800
