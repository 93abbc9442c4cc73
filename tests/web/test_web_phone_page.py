"""A phone's camera drives: the code in the page, the phone's own browser, and its leaving."""

import pytest
from browsing import chromium, click, drawn, until
from served import Served

from studio.synthetic.film import film

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def browsing(tmp_path_factory):
    """A Chromium whose camera shows who stands quiet, then sits down."""
    video = film(tmp_path_factory.mktemp("video") / "a.mjpeg", ("quiet", 4.0), ("sit_quiet", 6.0))
    shown = f"--use-file-for-fake-video-capture={video}"
    with chromium("--use-fake-device-for-media-stream", shown) as browsing:
        yield browsing


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A studio with a door for phones, on loopback."""
    options = ("--source", "operator:quiet", "--phone", "127.0.0.1", "--phone-port", "0")
    served = Served(tmp_path_factory.mktemp("sessions"), *options)
    yield served
    served.end_well()


def come(browsing, served):
    """A phone's browser that trusts this certificate, and opens the code's link."""
    context = browsing.browser.new_context(
        ignore_https_errors=True, permissions=["camera"], has_touch=True,
        viewport={"width": 390, "height": 780}, user_agent="Mozilla/5.0 (Linux; Android 16)",
    )  # fmt: skip
    phone = context.new_page()
    phone.on("pageerror", lambda error: browsing.problems.append(str(error)))
    phone.goto(served.client.get("/api/phone").json()["url"])
    return phone


def test_a_phone_that_scans_the_code_is_shown_and_can_be_sent_away(browsing, served):
    with browsing.page(served, 1300, 800, reduced_motion="reduce") as page:
        drawn(page)
        click(page, "#camera > summary")
        click(page, "#camera .phone summary")
        until(page, "() => document.querySelector('.phone .code')?.naturalWidth > 100")
        code = page.evaluate("() => document.querySelector('.phone .code').src")
        link = page.evaluate("() => document.querySelector('.phone div > a').href")
        assert link == served.client.get("/api/phone").json()["url"]
        phone = come(browsing, served)
        assert phone.url.endswith("/camera")
        until(page, "() => document.querySelector('.phones li')?.textContent.includes('Android')")
        until(page, f"() => document.querySelector('.phone .code').src !== {code!r}")
        click(page, ".phones button")
        until(page, "() => !document.querySelector('.phones li')")
        phone.reload()
        assert "Not invited" in phone.content()
        phone.context.close()


@pytest.mark.long
def test_who_stands_before_the_phone_makes_the_robot_sit(browsing, served):
    phone = come(browsing, served)
    phone.click("#start")
    until(phone, "() => a1camera.seen?.world")
    phone.click("#drive")
    until(phone, "() => a1camera.driving.stage === 'on'")
    served.wait(lambda s: s["armed"] and s["source"] == "webcam")
    served.wait(lambda s: s["expert"] == "sit" and s["state"] == "sit", 120.0)
    (one,) = served.client.get("/api/phone").json()["phones"]
    assert one["frames_per_s"] > 1.0
    served.client.post("/api/phone", json={"action": "send_away", "name": one["name"]})
    served.wait(lambda s: s["reason"] == "stale", 60.0)
    until(phone, "() => a1camera.driving.stage === 'off'")
    phone.context.close()
