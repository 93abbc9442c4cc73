"""An emulated headset (iwer) on the camera's page: head, hands and stick drive, its end stands."""

import json

import numpy as np
import pytest
from browsing import click, until

from studio.geometry import quat_to_rpy
from studio.paths import package_folder

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

IWER = package_folder("web_assets") / "node_modules" / "iwer" / "build" / "iwer.min.js"
TALL = 1.65
WORN = f"""
  window.device = new IWER.XRDevice(IWER.metaQuest3);
  device.installRuntime({{ forceInstall: true }});
  // iwer says of every place that it is only guessed.
  Object.defineProperty(XRPose.prototype, "emulatedPosition", {{ get: () => window.guessed }});
  window.guessed = false;
  window.wear = ({{ head = [0, {TALL}, 0], turned = [0, 0, 0, 1], left = [-0.25, 0.85, -0.1],
                   right = [0.25, 0.85, -0.1], stick = [0, 0] }}) => {{
    device.position.set(...head);
    device.quaternion.set(...turned);
    device.controllers.left.position.set(...left);
    device.controllers.right.position.set(...right);
    device.controllers.left.updateAxes('thumbstick', ...stick);
  }};
  wear({{}});
"""
"""A headset that stands upright, hands hanging; `wear` moves it."""
SAID = "() => document.querySelector('#said').textContent"


@pytest.fixture(scope="module")
def page(browsing, served):
    """The camera's page in a headset's browser."""
    assert IWER.is_file(), "npm install in web_assets brings iwer"
    script = IWER.read_text("utf-8") + WORN
    with browsing.page(served, 900, 640, path="/camera", script=script) as page:
        yield page


@pytest.fixture
def driving(page, served):
    """Who stands upright with the headset on, and is followed."""
    wear(page)
    if not page.evaluate("() => Boolean(a1camera.headset?.on)"):
        click(page, "#headset")
    until(page, "() => a1camera.headset?.on")
    if page.evaluate("() => a1camera.headset.driving.stage") == "off":
        click(page, "#drive")
    until(page, "() => a1camera.headset.driving.stage === 'on'")
    served.wait(lambda s: s["armed"] and s["source"] == "headset" and s["state"] == "stand")
    return page


def wear(page, **how):
    page.evaluate(f"() => wear({json.dumps(how)})")


def tick(served, true, seconds=60.0):
    """The first tick for which `true(tick)`, of those to come."""
    served.ticks.clear()

    def found(_):
        return any(true(one) for one in list(served.ticks.values()))

    served.wait(found, seconds)
    return next(one for one in list(served.ticks.values()) if true(one))


def tilt(one):
    """deg, roll and pitch of what the robot should do."""
    return np.degrees(quat_to_rpy(one["reference"]["base_quat"]))[:2]


def test_it_drives_once_it_has_kept_still_and_says_what_it_infers(driving, served):
    report = served.client.get("/api/state").json()["source_report"]
    assert set(report["joints_found"]) == {"head", "l_wrist", "r_wrist"}
    assert "inferred" in report["notes"][0]
    assert driving.evaluate("() => a1camera.headset.driving.refused.frames") == 0


def test_who_leans_makes_the_robot_lean_the_same_way(driving, served):
    wear(driving, head=[0, TALL - 0.08, -0.2])
    tick(served, lambda one: tilt(one)[1] > 8.0)
    wear(driving)
    tick(served, lambda one: abs(tilt(one)[1]) < 4.0)
    wear(driving, head=[0.2, TALL - 0.05, 0])
    tick(served, lambda one: tilt(one)[0] > 8.0)


def test_a_raised_controller_raises_that_paw(driving, served):
    wear(driving, right=[0.25, 1.85, -0.3])
    one = tick(served, lambda one: one["robot"]["foot_pos_w"][0][2] > 0.12)
    assert one["robot"]["foot_pos_w"][1][2] < 0.05


def test_who_goes_down_makes_the_robot_sit(driving, served):
    wear(driving, head=[0, TALL - 0.42, 0], left=[-0.25, 0.55, -0.2], right=[0.25, 0.55, -0.2])
    served.wait(lambda s: s["state"] == "sit")
    wear(driving)
    served.wait(lambda s: s["state"] == "stand")


def test_the_stick_walks_and_at_rest_the_robot_stands(driving, served):
    wear(driving, stick=[0, -1])
    served.wait(lambda s: s["state"] == "walk")
    wear(driving)
    served.wait(lambda s: s["state"] == "stand")


def test_behind_the_headsets_menu_nobody_is_followed(driving, served):
    wear(driving, stick=[0, -1])
    served.wait(lambda s: s["state"] == "walk")
    driving.evaluate("() => device.updateVisibilityState('visible-blurred')")
    served.wait(lambda s: s["reason"] == "stale" and s["state"] == "stand")
    wear(driving)
    driving.evaluate("() => device.updateVisibilityState('visible')")
    served.wait(lambda s: s["reason"] == "")


def test_who_is_no_longer_tracked_is_not_followed(driving, served):
    wear(driving, stick=[0, -1])
    served.wait(lambda s: s["state"] == "walk")
    driving.evaluate("() => { guessed = true; }")
    served.wait(lambda s: s["reason"] == "stale" and s["state"] == "stand")
    wear(driving)
    driving.evaluate("() => { guessed = false; }")
    served.wait(lambda s: s["reason"] == "")


def test_a_button_stops_and_another_goes_on(driving, served):
    driving.evaluate("() => device.controllers.right.updateButtonValue('b-button', 1)")
    served.wait(lambda s: s["stopped"])
    driving.evaluate("() => device.controllers.right.updateButtonValue('b-button', 0)")
    until(driving, "() => a1camera.headset.driving.stage === 'off'")
    driving.evaluate("() => device.controllers.right.updateButtonValue('a-button', 1)")
    served.wait(lambda s: s["armed"] and not s["stopped"])
    driving.evaluate("() => device.controllers.right.updateButtonValue('a-button', 0)")


def test_the_end_of_the_session_leaves_the_robot_standing_and_the_page_says_why(driving, served):
    wear(driving, stick=[0, -1])
    served.wait(lambda s: s["state"] == "walk")
    driving.evaluate("() => device.activeSession.end()")
    until(driving, f"() => ({SAID})().includes('session ended')")
    state = served.wait(lambda s: s["mode"] == "idle" and s["state"] == "stand")
    assert not state["stopped"]
    assert driving.evaluate("() => !a1camera.headset.on")


def test_without_a_headset_there_is_no_button_and_the_page_says_what_would_work(browsing, served):
    with browsing.page(served, 700, 500, path="/camera") as bare:
        why = "() => document.querySelector('#headset-why').textContent"
        until(bare, f"() => ({why})().includes('open this page in its own browser')")
        assert bare.evaluate("() => document.querySelector('#headset').hidden")
