"""The camera's page in a real Chromium, whose camera shows the synthetic person as a mannequin."""

import pytest
from browsing import FLAGS, chromium, click, launched, until

from studio.synthetic.film import film

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

NO_GRAPHICS = [flag for flag in FLAGS if "swiftshader" in flag]
"""The model shares two cores with whoever draws in software; this page needs no drawing."""
FAKE = ("--disable-gpu", "--use-fake-device-for-media-stream")
SAID = "() => document.querySelector('#said').textContent"


@pytest.fixture(scope="module")
def browsing(tmp_path_factory):
    """A Chromium whose camera shows who stands quiet, then sits down."""
    video = film(tmp_path_factory.mktemp("video") / "a.mjpeg", ("quiet", 4.0), ("sit_quiet", 6.0))
    with chromium(
        *FAKE, f"--use-file-for-fake-video-capture={video}", without=NO_GRAPHICS
    ) as browsing:
        yield browsing


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page of who allows the camera, the model loaded, a person seen."""
    with browsing.page(served, 900, 640, path="/camera", permissions=["camera"]) as page:
        click(page, "#start")
        until(page, "() => a1camera.seen?.world")
        yield page


@pytest.fixture
def driving(page, served):
    """Who stood quiet until the ring was full, and is followed now."""
    if page.evaluate("() => a1camera.driving.stage") == "off":
        click(page, "#drive")
    until(page, "() => a1camera.driving.stage === 'on'")
    served.wait(lambda s: s["armed"] and s["mode"] == "live" and s["source"] == "webcam")
    return page


def test_the_model_is_sure_of_the_mannequin_and_has_nothing_to_advise(page):
    sure = "() => parseInt(document.querySelector('#sure').textContent)"
    assert until(page, sure) >= 80
    until(page, "() => !a1camera.hint")
    # All 33 of MediaPipe's landmarks, the head above the hips in its axes: y down.
    seen = page.evaluate("() => a1camera.seen")
    assert len(seen["world"]) == len(seen["landmarks"]) == 33
    assert seen["world"][0][1] < -0.3
    assert seen["people"] == 1
    assert seen["light"] > 80


def test_who_sits_down_before_the_camera_makes_the_robot_sit(driving, served):
    served.wait(lambda s: s["expert"] == "sit" and s["state"] == "sit", 120.0)
    served.wait(lambda s: s["expert"] == "stand" and s["state"] == "stand", 120.0)
    report = served.client.get("/api/state").json()["source_report"]
    assert len(report["joints_found"]) == 19
    lit = """() => {
      const { width, height } = document.querySelector('#overlay');
      const paper = document.querySelector('#overlay').getContext('2d');
      return paper.getImageData(0, 0, width, height).data.some((v, i) => i % 4 === 3 && v > 0);
    }"""
    assert driving.evaluate(lit), "no skeleton over the picture"


def test_escape_stops_and_drive_goes_on(driving, served):
    driving.keyboard.press("Escape")
    served.wait(lambda s: s["stopped"])
    until(driving, "() => a1camera.driving.stage === 'off'")
    click(driving, "#drive")
    served.wait(lambda s: s["armed"] and not s["stopped"], 120.0)


def test_a_model_that_dies_is_started_again(driving):
    worker = driving.workers[0]
    worker.evaluate("() => { self.onmessage = null; }")  # it hears nothing more
    until(driving, f"() => ({SAID})().includes('starting it again')")
    until(driving, f"() => ({SAID})() === '' && performance.now() / 1000 - a1camera.seen.t < 2")


def test_a_camera_that_is_unplugged_leaves_the_robot_standing(driving, served):
    driving.evaluate(
        """() => {
          const [track] = document.querySelector('#video').srcObject.getTracks();
          track.stop();
          track.dispatchEvent(new Event('ended'));  // a browser says so only of others' doing
        }"""
    )
    until(driving, f"() => ({SAID})().includes('unplugged')")
    state = served.wait(lambda s: s["mode"] == "idle" and s["stale_s"] and s["stale_s"] > 0.5)
    assert not state["stopped"]
    click(driving, "#start")
    until(driving, "() => a1camera.camera.on && a1camera.seen?.world")


def test_a_camera_that_is_not_allowed_is_said_so(browsing, served):
    with browsing.page(served, 700, 500, path="/camera") as page:
        click(page, "#start")
        until(page, f"() => ({SAID})().includes('not allowed')")
        assert page.evaluate("() => document.querySelector('#drive').disabled")


def test_no_camera_is_said_so(served, browsing):
    none = "--use-fake-device-for-media-stream=device-count=0"
    kind = browsing.browser.browser_type
    with launched(kind, "--disable-gpu", none, without=NO_GRAPHICS) as other:
        with other.page(served, 700, 500, path="/camera", permissions=["camera"]) as bare:
            click(bare, "#start")
            until(bare, f"() => ({SAID})().includes('No camera was found')")
        assert other.problems == []


def test_the_panel_holds_the_page_and_escape_in_it_stops(served, browsing):
    post = served.client.post
    if served.client.get("/api/state").json()["stopped"]:
        post("/api/reset")
        post("/api/arm")
    with browsing.anything_goes(), browsing.page(served, 900, 700) as main:  # no WebGL here
        main.evaluate("() => { document.querySelector('#camera').open = true; }")
        until(main, "() => document.querySelector('#camera iframe')?.contentWindow.a1camera")
        main.frame_locator("#camera iframe").locator("#start").focus()
        main.keyboard.press("Escape")
        served.wait(lambda s: s["stopped"])
        main.evaluate("() => { document.querySelector('#camera').open = false; }")
        until(main, "() => !document.querySelector('#camera iframe')")
