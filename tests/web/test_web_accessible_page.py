"""For everyone: axe-core finds nothing in any panel, and the page works from the keyboard."""

import pytest
from axe import find_nothing
from browsing import click, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def served(example_sessions):
    """A studio with the two example takes."""
    served = Served(example_sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture
def live(page, served):
    """Live, armed, the synthetic person keeps quiet, nothing is open."""
    post = served.client.post
    if served.client.get("/api/state").json()["stopped"]:
        post("/api/reset")
        post("/api/arm")
    post("/api/source", json={"source": "operator:quiet"})
    post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live' && !a1studio.state.stopped")
    return page


def test_axe_finds_nothing_in_the_panels_for_driving(live, served):
    find_nothing(live)
    click(live, "#keys-drive")
    until(live, "() => !document.querySelector('#pad').hidden")
    find_nothing(live)


def test_axe_finds_nothing_in_the_transport(live, served):
    click(live, "#sample")
    until(live, "() => !document.querySelector('#transport').hidden")
    served.client.post("/api/transport", json={"action": "pause"})
    served.client.post("/api/transport", json={"action": "seek", "position_s": 1.0})
    find_nothing(live)
    served.client.post("/api/transport", json={"action": "seek", "position_s": 1000.0})
    until(live, "() => !document.querySelector('#transport-end').hidden")
    find_nothing(live)


def test_axe_finds_nothing_in_the_dialogs_and_after_a_stop(live, served):
    click(live, "#help")
    until(live, "() => document.querySelector('#shortcuts').open")
    find_nothing(live)
    live.keyboard.press("Escape")
    click(live, "#stop")
    until(live, "() => a1studio.state.stopped && !document.querySelector('#stopped').hidden")
    find_nothing(live)


def test_axe_finds_nothing_while_collecting_and_reviewing(live, served):
    click(live, '#mode [data-mode="collect"]')
    until(live, "() => document.querySelectorAll('#collected li[data-name]').length > 0")
    until(live, "() => document.querySelectorAll('.bins i').length > 0")
    find_nothing(live)
    click(live, "#collected li[data-name=example-tilt-and-reach] button")
    until(live, "() => document.querySelector('#bench-align')?.textContent")
    find_nothing(live)
    click(live, '#bench-keep [data-keep="false"]')
    until(live, "() => document.querySelector('#collected li.rejected')")
    find_nothing(live)
    click(live, "#bench-undo")
    until(live, "() => !document.querySelector('#collected li.rejected')")
    click(live, "#bench-close")


def test_stop_is_the_first_stop_of_the_tab_key_after_the_skip_link(live):
    live.evaluate("() => { document.activeElement.blur(); }")
    live.keyboard.press("Tab")
    skip = live.evaluate("() => document.activeElement.className")
    assert skip == "skip"
    live.keyboard.press("Tab")
    assert live.evaluate("() => document.activeElement.id") == "stop"
    live.keyboard.press("Shift+Tab")
    live.keyboard.press("Enter")
    assert live.evaluate("() => document.activeElement.id") == "panels"
    assert live.evaluate("() => document.querySelectorAll('h1').length") == 1


def test_the_timeline_is_a_slider_that_speaks(live, served):
    click(live, '#mode [data-mode="collect"]')
    click(live, "#collected li[data-name=example-tilt-and-reach] button")
    until(
        live, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )
    live.focus("#timeline")
    said = "() => document.querySelector('#timeline').getAttribute('aria-valuetext')"
    assert live.evaluate(said).startswith("0.00 of 15.70 seconds")
    for key, t in (("ArrowRight", 1 / 30), ("PageUp", 1 + 1 / 30), ("End", 15.7), ("Home", 0.0)):
        live.keyboard.press(key)
        # The last frame begins before the end of the take.
        until(live, f"() => Math.abs(a1studio.state.replay.t - {t}) < 0.04")
        shown = "a1studio.state.replay.t.toFixed(2)"
        until(live, f"() => ({said})().startsWith(`${{{shown}}} of`)")
    assert live.evaluate("() => document.querySelector('#timeline').role") == "slider"
    click(live, "#bench-close")


def test_the_camera_jumps_where_no_motion_is_wanted(live):
    inside = "document.querySelector('#view').contentWindow.__viserMutable"
    moved = live.evaluate(
        f"""async () => {{
          const eye = () => {inside}.cameraControl.getPosition(
            {inside}.camera.position.clone(), false).toArray();
          document.querySelector('[data-camera=top]').click();
          const at = eye();
          await new Promise((done) => setTimeout(done, 500));
          return Math.hypot(...eye().map((v, i) => v - at[i]));
        }}"""
    )
    assert moved == 0.0
    click(live, "[data-camera=front]")
