"""A stop that does not arrive is told of loudly, stale figures are veiled, Esc knows stillness."""

import re
import signal
import time

import pytest
from browsing import drawn, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that may be held up, killed and begun anew."""
    served = Served(tmp_path_factory.mktemp("sessions"), "--source", "operator:tilt")
    yield served
    served.end_well()


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, which complains only where it has reason to."""
    with browsing.page(served, 760, 560) as page:
        yield drawn(page)
    assert not browsing.problems


def calm(page, served):
    """Live, armed, nothing open."""
    post = served.client.post
    if served.client.get("/api/state").json()["stopped"]:
        assert post("/api/reset").status_code == 200
        assert post("/api/arm").status_code == 200
    post("/api/mode", json={"mode": "live"})
    until(page, "() => !window.a1studio.state.stopped && window.a1studio.state.mode === 'live'")


SHORTCUTS = "() => document.querySelector('#shortcuts').open"
CLOSED = "() => !document.querySelector('#shortcuts').open"
STILL = "() => window.a1studio.still"


def test_escape_stops_a_robot_that_moves_and_closes_what_is_open(page, served):
    calm(page, served)
    page.keyboard.press("?")
    until(page, SHORTCUTS)
    until(page, "() => !window.a1studio.still")  # it tilts
    page.keyboard.press("Escape")
    served.wait(lambda s: s["stopped"])
    until(page, CLOSED)


def test_escape_only_closes_help_while_the_robot_is_still(page, served):
    calm(page, served)
    served.client.post("/api/mode", json={"mode": "idle"})
    until(page, STILL)
    page.keyboard.press("?")
    until(page, SHORTCUTS)
    page.keyboard.press("Escape")
    until(page, CLOSED)
    assert served.client.get("/api/state").json()["stopped"] is False
    page.keyboard.press("Escape")  # nothing is open any more
    served.wait(lambda s: s["stopped"])
    page.keyboard.press("?")
    until(page, SHORTCUTS)
    stops = served.client.get("/api/state").json()["stops"]
    page.keyboard.press("Escape")  # stopped already
    until(page, CLOSED)
    assert served.client.get("/api/state").json()["stops"] == stops


def test_a_stop_that_arrives_raises_no_alarm(page, served):
    calm(page, served)
    page.click("#stop")
    served.wait(lambda s: s["stopped"])
    time.sleep(2.0)
    assert page.evaluate("() => document.querySelector('#alarm').hidden")
    assert page.evaluate("() => document.querySelector('#stale').hidden")


def test_a_server_that_hangs_is_alarmed_of_until_the_stop_arrives(page, served):
    calm(page, served)
    served.process.send_signal(signal.SIGSTOP)
    try:
        until(page, "() => !document.querySelector('#stale').hidden")
        silence = re.search(r"No data for (\d+) s", page.text_content("#stale"))
        assert silence
        assert int(silence[1]) >= 3  # a hiccup is none
        page.keyboard.press("Escape")
        until(page, "() => !document.querySelector('#alarm').hidden")
        assert "NOT DELIVERED" in page.text_content("#alarm")
        assert "NOT DELIVERED" in page.title()
        assert page.is_hidden("#alarm button")
    finally:
        served.process.send_signal(signal.SIGCONT)
    state = served.wait(lambda s: s["stopped"])
    assert "emergency stop" in state["why"]
    until(page, "() => document.querySelector('#alarm').dataset.kind === 'delivered'")
    assert "has arrived" in page.text_content("#alarm")
    assert page.title() == "A1 Studio"
    page.click("#alarm button")
    until(page, "() => document.querySelector('#stale').hidden")
    assert page.is_hidden("#alarm")


@pytest.mark.long
def test_a_page_left_open_comes_back_when_the_studio_is_started_anew(browsing, tmp_path):
    sessions = tmp_path / "sessions"
    first = Served(sessions, "--source", "operator:tilt")
    with browsing.anything_goes(), browsing.page(first, 760, 560) as page:
        drawn(page)
        first.process.send_signal(signal.SIGKILL)
        first.process.wait(20.0)
        first.close()
        until(page, "() => !document.querySelector('#stale').hidden")
        page.keyboard.press("Escape")
        until(page, "() => !document.querySelector('#alarm').hidden")
        second = Served(sessions, "--source", "operator:tilt", port=first.port)
        try:
            assert second.token == first.token
            second.wait(lambda s: s["stopped"])  # the stop arrives after all
            until(page, "() => document.querySelector('#alarm').dataset.kind === 'delivered'")
            until(page, "() => document.querySelector('#stale').hidden")
            until(page, "() => window.a1studio.state.control.pages.length > 0")
        finally:
            second.close()
        third = Served(sessions, "--token", "quite-another", port=first.port)
        try:
            until(page, "() => !document.querySelector('#stale a').hidden")
            page.click("#stale a")
            page.wait_for_selector("input[name=token]")
            page.fill("input[name=token]", "quite-another")
            page.click("button")
            drawn(page)
        finally:
            third.close()
