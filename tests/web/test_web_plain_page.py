"""The page says what it did, in its user's words; nothing moves that nobody moved."""

import math

import pytest
from browsing import click, drawn, until
from rendered import RENDERED, iter_links

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

EYE = """() => document.querySelector('#view').contentWindow.__viserMutable
  .camera.position.toArray()"""


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, its view drawn."""
    with browsing.page(served, 1100, 700) as page:
        yield drawn(page)


@pytest.fixture
def live(page, served):
    """Live, armed, on a quiet person."""
    post = served.client.post
    state = served.client.get("/api/state").json()
    if state["stopped"]:
        assert post("/api/reset").status_code == 200
        assert post("/api/arm").status_code == 200
    post("/api/mode", json={"mode": "live"})
    post("/api/source", json={"source": "operator:quiet"})
    until(page, "() => !a1studio.state.stopped && a1studio.state.source === 'operator:quiet'")
    return page


def focus_view(page) -> None:
    """The keyboard is the framed view's."""
    page.evaluate(
        """() => { const view = document.querySelector('#view');
        view.focus(); view.contentWindow.focus(); }"""
    )


@pytest.mark.parametrize("drives", [False, True])
def test_keys_in_the_view_drive_the_person_and_never_fly_the_camera(live, served, drives):
    if drives:
        click(live, "#keys-drive")
        until(live, "() => a1studio.state.source === 'operator:interactive'")
    focus_view(live)
    before = live.evaluate(EYE)
    for key in ("w", "a", "s", "d", "q", "e", "ArrowUp"):
        live.keyboard.down(key)
    if drives:
        until(live, "() => document.querySelectorAll('#pad .held').length >= 6")
    live.wait_for_timeout(1500)
    for key in ("w", "a", "s", "d", "q", "e", "ArrowUp"):
        live.keyboard.up(key)
    assert live.evaluate(EYE) == before
    if drives:
        until(live, "() => !document.querySelector('#pad .held')")


def test_walking_says_that_it_is_under_way(live, served):
    click(live, "#keys-drive")
    until(live, "() => a1studio.state.source === 'operator:interactive'")
    live.evaluate(
        """() => { window.told = [];
        const pill = document.querySelector('#underway');
        new MutationObserver(() => pill.hidden || told.push(pill.textContent)).observe(
          pill, { subtree: true, childList: true, characterData: true, attributes: true }); }"""
    )
    live.keyboard.down("w")
    served.wait(lambda s: s["state"] == "walk")
    until(live, "() => document.querySelector('#underway').hidden")
    live.keyboard.up("w")
    told = live.evaluate("() => told")
    assert "Walking begins" in told[0]
    assert any("changes to walking" in words for words in told), told


def test_after_a_reset_enter_arms_and_a_stop_is_said_to_be_this_page_s(live, served):
    click(live, "#stop")
    until(live, "() => /by this page/.test(document.querySelector('#status').textContent)")
    assert "page-" not in live.text_content("#status")
    live.focus("#reset")
    live.keyboard.press("Enter")
    until(live, "() => document.activeElement.id === 'arm'")
    stops = served.client.get("/api/state").json()["stops"]
    live.keyboard.press(" ")  # never arms
    until(live, f"() => a1studio.state.stops > {stops}")  # it undoes no stop that it has not seen
    live.focus("#reset")
    live.keyboard.press("Enter")
    until(live, "() => document.activeElement.id === 'arm'")
    live.keyboard.press("Enter")
    served.wait(lambda s: s["armed"] and not s["stopped"])


def test_recording_moves_nothing_and_a_take_thrown_away_comes_back(live, served):
    places = """() => ['#mode', '#chip-source', '#view', '#panels', '#stop'].map(
      (s) => JSON.stringify(document.querySelector(s).getBoundingClientRect()))"""
    until(live, "() => !document.querySelector('#stop').getAnimations().length")  # once pressed
    before = live.evaluate(places)
    click(live, "#record")
    until(live, "() => !document.querySelector('#chip-rec').hidden")
    served.wait(lambda s: s["recording"] and s["recording"]["ticks"] > 15)
    assert live.evaluate(places) == before
    assert live.query_selector("#takes [aria-label^=Delete]") is None  # it is being recorded
    click(live, "#record")
    until(live, "() => document.querySelector('#takes [aria-label^=Delete]')")
    name = served.client.get("/api/takes").json()[0]["name"]
    click(live, f'#takes [aria-label="Delete {name}"]')
    until(live, "() => document.querySelector('.toast .undo')")
    assert served.client.get("/api/takes").json() == []
    click(live, ".toast .undo")
    until(live, "() => document.querySelector('#takes [aria-label^=Delete]')")
    assert [take["name"] for take in served.client.get("/api/takes").json()] == [name]


def test_calibrating_says_what_it_found_or_why_it_cannot(live, served, browsing):
    until(live, "() => a1studio.state.stale_s < 0.5")
    click(live, "#calibrate")
    until(live, "() => /Calibrated: .* leg is 0\\.\\d+ m/.test(toasts.textContent)")
    served.client.post("/api/source", json={"source": "stream"})
    served.wait(lambda s: s["source"] == "stream")
    assert live.evaluate("() => toasts.textContent").count("nobody") == 0
    with browsing.expecting("status of 409"):
        click(live, "#calibrate")
        why = "/(Nobody seen yet|Stale).*; stand before the sensor/.test(toasts.textContent)"
        until(live, f"() => {why}")


def test_a_page_that_watches_looks_it(live, served, browsing):
    assert live.is_hidden("#watching")
    with browsing.page(served, 900, 600) as second:
        until(second, "() => !document.querySelector('#watching').hidden")
        assert "Another page drives" in second.text_content("#watching")
        click(second, "#watching-ask")
        until(live, "() => !document.querySelector('#asked').hidden")
        assert "Another page asks to drive" in live.inner_text("#asked")
        click(live, "#asked-keep")
        until(live, "() => document.querySelector('#asked').hidden")
        until(second, "() => document.querySelector('#watching-ask').innerText === 'Ask'")
        click(second, "#watching-ask")
        until(live, "() => !document.querySelector('#asked').hidden")
        click(live, "#asked-over")
        until(second, "() => document.querySelector('#watching').hidden")
        click(live, "#watching-take")
        until(second, "() => !document.querySelector('#watching').hidden")
        click(second, "#watching-take")
        until(second, "() => document.querySelector('#watching').hidden")
        until(live, "() => !document.querySelector('#watching').hidden")
        click(second, "#stop")
        until(live, "() => /by another page/.test(document.querySelector('#status').innerText)")
    click(live, "#watching-take")
    until(live, "() => document.querySelector('#watching').hidden")


@pytest.mark.parametrize("mirror", [True, False])
def test_what_is_shown_faces_as_the_mirror_switch_says(live, served, mirror):
    served.client.post("/api/mirror", json={"mirror": mirror})
    click(live, '#mode [data-mode="collect"]')
    until(live, "() => a1studio.tick.mode === 'collect'")
    live.wait_for_timeout(1000)  # a picture of that tick
    _, quat = iter_links(live.evaluate(RENDERED), "reference")["trunk"]
    w, _, _, z = quat
    yaw = abs(2.0 * math.atan2(z, w))
    assert min(yaw, 2.0 * math.pi - yaw) == pytest.approx(0.0 if mirror else math.pi, abs=0.3)
    served.client.post("/api/mode", json={"mode": "live"})
    served.client.post("/api/mirror", json={"mirror": False})
