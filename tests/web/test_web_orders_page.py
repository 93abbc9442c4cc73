"""Odd orders in a real Chromium: a fall, a stop in the review, an ended clip, lines that broke."""

import time

import numpy as np
import pytest
from browsing import PATIENCE, click, drawn, until
from line import line
from served import Served

from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

TAKE = "example-tilt-and-reach"


@pytest.fixture(scope="module")
def served(example_sessions):
    """A studio with the two example takes."""
    served = Served(example_sessions, "--source", "operator:quiet")
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


def planned(page, *, preview: bool = False) -> None:
    """One short motion to act out, ready to begin."""
    until(page, "() => document.querySelectorAll('#plan .choice').length === 12")
    page.evaluate(
        """(preview) => { document.querySelector('#collect').open = true;
        document.querySelector('#collect-seconds').value = 2;
        document.querySelector('#collect-preview').checked = preview; }""",
        preview,
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


def reviewed(page) -> None:
    """A take is on the bench, from mode collect."""
    click(page, '#mode [data-mode="collect"]')
    click(page, f"#collected li[data-name={TAKE}] button")
    until(
        page, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )


def test_a_stop_in_the_review_holds_in_collect_until_a_reset(live, served):
    reviewed(live)
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


def test_abort_stays_under_the_finger_from_the_preview_until_the_take_ends(live):
    click(live, '#mode [data-mode="collect"]')
    planned(live, preview=True)
    live.evaluate(
        """() => {
          const abort = document.querySelector('[data-action="abort"]');
          window.places = {};
          new MutationObserver(() => {
            const { phase } = a1studio.state.collect;
            if (!abort.hidden) places[phase] = abort.getBoundingClientRect().x;
          }).observe(document.querySelector('#coach'), { subtree: true, characterData: true,
            childList: true });
        }"""
    )
    click(live, '[data-action="go"]')
    until(live, "() => a1studio.state.collect.phase === 'record'")
    until(live, "() => 'record' in places")
    places = live.evaluate("() => places")
    assert {"preview", "countdown", "record"} <= set(places)
    assert len(set(places.values())) == 1, places
    click(live, '[data-action="abort"]')
    until(live, "() => a1studio.state.collect.phase === 'ready'")


def test_a_mode_chosen_while_a_review_closes_is_not_undone(live, served):
    reviewed(live)
    held = []
    live.route("**/api/mode", lambda route: held.append(route))
    live.evaluate("() => document.querySelector('#bench-close').click()")
    deadline = time.monotonic() + PATIENCE
    while not held:
        assert time.monotonic() < deadline
        live.wait_for_timeout(50)
    assert served.client.post("/api/mode", json={"mode": "idle"}).status_code == 200
    with live.expect_response("**/api/mode") as answer:
        held[0].continue_()
    assert answer.value.json()["mode"] == "idle"
    live.unroute("**/api/mode")


def test_who_collects_with_a_clip_that_has_ended_is_refused_and_offered_the_operator(
    live, served, browsing, tmp_path
):
    person = OperatorSource("quiet", seed=5)
    poses = [pose for k in range(60) if (pose := person.read(k / 30.0))]
    write_bvh(tmp_path / "short.bvh", np.array([p.joint_pos_w for p in poses]), 1.0 / 30.0)
    live.set_input_files("#file", tmp_path / "short.bvh")
    until(live, "() => document.querySelector('#transport-end')?.offsetParent")
    assert "The robot stands" in live.inner_text("#transport-end")
    click(live, '#mode [data-mode="collect"]')
    planned(live)
    until(live, "() => /has ended/.test(document.querySelector('#coach .why').textContent)")
    assert live.is_disabled('[data-action="go"]')
    with browsing.expecting("status of 409"):
        live.keyboard.press("h")
        until(live, "() => /has ended/.test(document.querySelector('#toasts').textContent)")
    assert served.client.get("/api/state").json()["recording"] is None
    live.get_by_role("button", name="Let the synthetic person act").click()
    served.wait(lambda s: s["source"].startswith("operator") and s["mode"] == "collect")
    acted(live, served)


def test_the_page_that_drives_is_closed_and_another_takes_over(live, served, browsing):
    served.client.post("/api/source", json={"source": "operator:tilt"})
    with browsing.page(served, 500, 400) as other:
        other.wait_for_selector("#control[data-held=other]")
        other.click("#control")
        live.wait_for_selector("#control[data-held=other]")
        assert "Another page drives" in live.inner_text("#watching")
    served.wait(lambda s: s["reason"] == "page_lost")
    until(live, "() => /is closed/.test(document.querySelector('#watching').innerText)")
    live.get_by_role("button", name="Take control").first.click()
    live.wait_for_selector("#control[data-held=you]")
    served.wait(lambda s: not s["reason"])
    assert live.is_hidden("#watching")


def test_a_page_reloaded_while_recording_loses_nothing_and_says_so(live, served):
    click(live, "#record")
    begun = served.wait(lambda s: s["recording"] and s["recording"]["ticks"] > 30)["recording"]
    live.reload()
    drawn(live)
    until(live, "() => /goes on/.test(document.querySelector('#toasts').textContent)")
    live.wait_for_selector("#control[data-held=you]")
    assert live.get_attribute("#record", "aria-pressed") == "true"
    assert live.is_visible("#chip-rec")
    ticks = served.wait(lambda s: not s["reason"])["recording"]["ticks"]
    assert ticks > begun["ticks"]
    click(live, "#record")
    served.wait(lambda s: s["recording"] is None)
    take = served.client.get(f"/api/takes/{begun['name']}").json()
    assert take["ticks"] >= ticks
    assert not take["damaged"]


def test_a_page_offline_for_five_seconds_comes_back_by_itself(live, served, browsing):
    served.client.post("/api/source", json={"source": "operator:tilt"})
    with line(served) as wire, browsing.page(wire, 760, 560) as page:
        drawn(page)
        page.click("#control")
        page.wait_for_selector("#control[data-held=you]")
        served.wait(lambda s: not s["reason"])
        wire.alive.clear()
        served.wait(lambda s: s["reason"] == "page_lost")
        until(page, "() => !document.querySelector('#stale').hidden")
        assert "No data for" in page.inner_text("#stale")
        page.wait_for_timeout(2000)
        wire.alive.set()
        until(page, "() => document.querySelector('#stale').hidden")
        served.wait(lambda s: not s["reason"])
        assert page.get_attribute("#control", "data-held") == "you"
        assert page.is_hidden("#alarm")
        assert page.inner_text("#chip-link") == "Connected"
