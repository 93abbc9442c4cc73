"""Odd orders in a real Chromium: what follows a fall, and a stop in the review."""

import shutil

import pytest
from browsing import click, until
from served import Served

from studio.paths import package_folder

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

TAKE = "example-tilt-and-reach"


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A studio with the two example takes."""
    sessions = tmp_path_factory.mktemp("root") / "sessions"
    shutil.copytree(package_folder("sessions"), sessions)
    served = Served(sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture
def live(page, served):
    """Live, armed, on a quiet person, nothing recorded; whoever drove, this page does now."""
    served.client.post("/api/takes/stop")
    begin_anew(served)
    until(page, "() => a1studio.state.mode === 'live' && !a1studio.state.stopped")
    until(page, "() => document.body.dataset.work === ''")
    if page.get_attribute("#control", "data-held") != "you":
        click(page, "#control")
        page.wait_for_selector("#control[data-held=you]")
    return page


def begin_anew(served: Served) -> None:
    post = served.client.post
    if served.client.get("/api/state").json()["stopped"]:
        assert post("/api/reset").status_code == 200
    post("/api/arm")
    post("/api/controller", json={"controller": "policy"})
    post("/api/source", json={"source": "operator:quiet"})
    post("/api/mode", json={"mode": "live"})


def planned(page) -> None:
    """One short motion to act out, ready to begin."""
    until(page, "() => document.querySelectorAll('#plan .choice').length === 12")
    page.evaluate(
        """() => { document.querySelector('#collect').open = true;
        document.querySelector('#collect-seconds').value = 2;
        document.querySelector('#collect-preview').checked = false; }"""
    )
    if page.inner_text('.choice[data-task="tilt"] output') == "0":
        click(page, '.choice[data-task="tilt"] button:last-child')
    click(page, "#collect-begin")
    until(page, "() => a1studio.state.collect.phase === 'ready'")


def acted(page, served: Served) -> None:
    """It is acted out, and kept."""
    for phase, action in (("ready", "go"), ("review", "keep")):
        until(page, f"() => a1studio.state.collect.phase === '{phase}'")
        click(page, f'[data-action="{action}"]')
    served.wait(lambda s: s["collect"]["phase"] == "done" and s["collect"]["kept"])


def test_a_fall_is_on_the_take_that_is_recorded_and_the_take_goes_on_after_the_reset(live, served):
    served.client.post("/api/source", json={"source": "operator:walk"})
    click(live, "#record")
    served.wait(lambda s: s["recording"] and s["recording"]["ticks"] > 10)
    served.client.post("/api/controller", json={"controller": "pd_playback"})  # it falls in 5 s
    served.wait(lambda s: s["counters"].get("falls", 0) > 0)
    until(live, "() => !document.querySelector('#stopped').hidden")
    fallen = served.wait(lambda s: s["recording"])["recording"]["ticks"]
    served.client.post("/api/controller", json={"controller": "policy"})
    click(live, "#reset")
    served.wait(lambda s: not s["needs_reset"])
    click(live, "#arm")
    served.wait(lambda s: s["recording"]["ticks"] > fallen + 30)
    name = served.client.get("/api/state").json()["recording"]["name"]
    click(live, "#record")
    until(live, f"() => document.querySelector('#takes [aria-label=\"Delete {name}\"]')")
    take = served.client.get(f"/api/takes/{name}").json()
    assert take["ticks"] > fallen + 30
    assert not take["damaged"]
    tilts = served.client.get(f"/api/takes/{name}/series").json()["signals"]
    assert max(map(abs, [*tilts["roll_done_deg"], *tilts["pitch_done_deg"]])) > 30.0


def test_a_stop_in_the_review_holds_in_collect_until_a_reset(live, served):
    click(live, '#mode [data-mode="collect"]')
    click(live, f"#collected li[data-name={TAKE}] button")
    until(
        live, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )
    click(live, "#stop")
    served.wait(lambda s: s["stopped"])
    click(live, "#bench-close")
    until(live, "() => !document.body.hasAttribute('data-reviewing')")
    click(live, '#mode [data-mode="collect"]')
    until(live, "() => document.querySelector('#collect')?.offsetParent")
    assert served.client.get("/api/state").json()["stopped"]  # no mode frees it
    click(live, "#reset")
    served.wait(lambda s: not s["needs_reset"])
    click(live, "#arm")
    served.wait(lambda s: s["armed"] and not s["stopped"])
    planned(live)
    acted(live, served)
