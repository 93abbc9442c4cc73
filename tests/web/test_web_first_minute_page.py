"""What a new user meets: the names of the figures, a sample, a pad for touch, a guide."""

import numpy as np
import pytest
from browsing import click, drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

NAMES = "() => [...document.querySelectorAll('.caption b')].map((b) => b.textContent)"
BOXES = """() => {
  const captions = [...document.querySelectorAll('.caption')];
  if (captions.some((c) => c.style.visibility !== 'visible')) return null;
  const edges = ({ left, top, right, bottom }) => [left, top, right, bottom];
  return captions.map((c) => edges(c.getBoundingClientRect()));
}"""
"""Edges, px, once all three are in sight."""


def test_nothing_can_be_pressed_before_the_page_s_code_is_there(served, browsing):
    pressed = """() => {
      const { x, y, width, height } = document.querySelector('#keys-drive').getBoundingClientRect();
      return document.elementFromPoint(x + width / 2, y + height / 2)?.closest('#keys-drive');
    }"""
    with browsing.page(served, 1024, 700) as page:
        until(page, f"() => ({pressed})()")
        held = []
        page.route("**/assets/js/app.js", lambda route: held.append(route))
        page.reload(wait_until="commit")
        page.wait_for_selector("#keys-drive")
        assert not page.evaluate(f"() => Boolean(({pressed})())")
        held[0].continue_()
        until(page, f"() => ({pressed})()")
        assert not page.evaluate("() => document.querySelector('[inert]')")


@pytest.mark.parametrize("width", [390, 1100])
def test_the_figures_are_named_for_what_they_are(served, browsing, width):
    served.client.post("/api/source", json={"source": "operator:quiet"})
    with browsing.page(served, width, 844, reduced_motion="reduce") as page:
        drawn(page)
        until(page, f"() => ({NAMES})()[0] === 'Synthetic person'")
        assert page.evaluate(NAMES)[1:] == ["What it should do", "What physics lets it do"]
        boxes = np.array(until(page, BOXES))
        for k, one in enumerate(boxes):
            for other in boxes[k + 1 :]:  # none over another
                assert (one[:2] >= other[2:]).any() or (one[2:] <= other[:2]).any(), boxes
        assert boxes.min() >= 0
        assert boxes[:, [0, 2]].max() <= width
        served.client.post("/api/source", json={"source": "stream"})
        until(page, f"() => ({NAMES})()[0] === 'You'")


def test_a_sample_drives_the_robot_by_one_click(served, browsing):
    with browsing.page(served, 1024, 700) as page:
        drawn(page)
        click(page, "#sample")
        served.wait(lambda s: s["source"].endswith("/lean-march-reach.bvh"))
        until(page, f"() => ({NAMES})()[0] === 'Recorded person'")
        # By the ticks: a page this busy may be slower than the sample is long.
        served.wait(lambda _: any(tick["state"] == "walk" for tick in [*served.ticks.values()]))


def test_a_finger_on_the_pad_drives_for_as_long_as_it_lies_there(served, browsing):
    served.client.post("/api/source", json={"source": "operator:quiet"})
    with browsing.page(served, 390, 844, has_touch=True, is_mobile=True) as page:
        drawn(page)
        click(page, "#keys-drive")
        until(page, "() => !document.querySelector('#pad').hidden")
        box = page.locator("#pad button").first.bounding_box()
        stop = page.locator("#stop").bounding_box()
        assert box["height"] >= 44
        assert box["y"] + box["height"] < stop["y"]  # in sight, without scrolling by hand
        finger = page.context.new_cdp_session(page)
        at = {"x": box["x"] + box["width"] / 2, "y": box["y"] + box["height"] / 2}
        finger.send("Input.dispatchTouchEvent", {"type": "touchStart", "touchPoints": [at]})
        served.wait(lambda s: s["state"] == "walk")
        assert page.evaluate("() => document.querySelectorAll('#pad .held').length") == 1
        finger.send("Input.dispatchTouchEvent", {"type": "touchEnd", "touchPoints": []})
        until(page, "() => !document.querySelector('#pad .held')")
        served.wait(lambda s: s["state"] == "stand")
        click(page, '#mode [data-mode="collect"]')  # whose panels are seen from the first on
        begins = """() => {
          const card = document.querySelector('#collect summary')?.getBoundingClientRect();
          return card?.height && card.top > document.querySelector('.stage')
            .getBoundingClientRect().bottom && card.bottom < innerHeight;
        }"""
        until(page, begins, 30.0)
    served.client.post("/api/mode", json={"mode": "live"})


def step(page, button: str) -> None:
    """Wait for the guide's step with this button, and press it."""
    words = f"() => document.querySelector('#guide .main').textContent === '{button}'"
    until(page, words)
    click(page, "#guide .main")


def test_the_first_minute_is_guided_to_a_mapper_of_one_s_own(served, browsing):
    served.client.post("/api/source", json={"source": "operator:quiet"})
    with browsing.page(served, 1024, 700) as page:
        drawn(page)
        assert page.locator("#guide").bounding_box()["y"] < 200
        step(page, "Use the keyboard")
        until(page, "() => a1studio.state.source === 'operator:interactive'")
        page.keyboard.down("w")
        step(page, "Try a sample")
        page.keyboard.up("w")
        step(page, "Record")
        served.wait(lambda s: s["recording"] and s["recording"]["ticks"] > 60)
        step(page, "Record")
        step(page, "Review the take")
        step(page, "Keep it, go to Train")
        until(page, "() => document.querySelector('#guide').hidden")
        until(page, "() => document.activeElement.closest('#train')")
        (take,) = served.client.get("/api/takes").json()
        assert take["kept"] is True
    served.client.post("/api/mode", json={"mode": "live"})


def test_the_guide_asks_nobody_to_drive_where_the_robot_follows_nobody(served, browsing):
    served.client.post("/api/source", json={"source": "operator:quiet"})
    with browsing.page(served, 1024, 700) as page:
        drawn(page)
        click(page, '#mode [data-mode="collect"]')
        until(page, "() => a1studio.state.mode === 'collect'")
        until(page, "() => !document.querySelector('#guide').innerText.includes('hold W')")
        step(page, "Go to Live")
        served.wait(lambda s: s["mode"] == "live")
        step(page, "Use the keyboard")
        assert "hold W" in page.inner_text("#guide")
        served.wait(lambda s: s["source"] == "operator:interactive")
    served.client.post("/api/source", json={"source": "operator:quiet"})


def test_the_guide_is_skipped_for_good_and_found_again(served, browsing):
    with browsing.page(served, 1024, 700) as page:
        drawn(page)
        click(page, "#guide .skip-guide")
        assert page.is_hidden("#guide")
        page.reload()
        drawn(page)
        assert page.is_hidden("#guide")
        page.set_viewport_size({"width": 390, "height": 844})
        click(page, "#help")
        until(page, "() => document.querySelector('#shortcuts').open")
        hit = """([what, x, y]) => {
          const box = document.querySelector(what).getBoundingClientRect();
          const at = [box.x + x * box.width, box.y + y * box.height];
          return Boolean(document.elementFromPoint(...at)?.closest(what));
        }"""
        for what, x, y in (("#shortcuts h2", 0.1, 0.5), ("#stop", 0.5, 0.1), ("#stop", 0.1, 0.1)):
            assert page.evaluate(hit, [what, x, y]), what  # from its beginning, beside STOP
        page.set_viewport_size({"width": 1024, "height": 700})
        click(page, "#guide-again")
        assert "hold W" in page.inner_text("#guide")


def test_everything_the_page_can_do_is_found_by_typing(served, browsing):
    served.client.post("/api/source", json={"source": "operator:quiet"})
    with browsing.page(served, 1024, 700) as page:
        drawn(page)
        page.keyboard.press("Control+k")
        until(page, "() => document.querySelector('#palette').open")
        page.keyboard.type("person cro")
        until(page, "() => document.querySelectorAll('#palette li').length === 1")
        page.keyboard.press("Enter")
        served.wait(lambda s: s["source"] == "operator:crouch")
        until(page, "() => !document.querySelector('#palette').open")
