"""The bar below the view: a clip is played, paused, sought by key, ends, and is played again."""

import pytest
from browsing import click, drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

PLAYED = "a1studio.state.transport"
SAYS = "document.querySelector('#transport-at').getAttribute('aria-valuetext')"
SHOWN = "!document.querySelector('{}').hidden"


@pytest.fixture
def sample(served, browsing, request):
    """A page as wide as asked on which the sample plays: slowly, for a page may be slower still."""
    served.client.post("/api/source", json={"source": "operator:quiet"})
    width = getattr(request, "param", 1100)
    with browsing.page(served, width, 844, reduced_motion="reduce") as page:
        drawn(page)
        # The page of the test before may not have left yet.
        if until(page, "() => document.body.dataset.role") == "watch":
            click(page, "#watching-take")
        until(page, "() => document.body.dataset.role === 'drive'")
        assert page.evaluate("() => document.querySelector('#transport').hidden")
        click(page, "#sample")
        until(page, f"() => {SHOWN.format('#transport')}")
        slowed(served)
        until(page, f"() => {PLAYED}.playing")
        yield page


def slowed(served) -> None:
    """The clip is at its start and takes minutes."""
    for body in ({"action": "speed", "speed": 0.1}, {"action": "again"}):
        answer = served.client.post("/api/transport", json=body)
        assert answer.status_code == 200, answer.text


def reached(page, place: float) -> None:
    """The studio is paused at this place, and the slider says so."""
    until(page, f"() => Math.abs({PLAYED}.position_s - {place}) < 0.05")
    length = "Number(a1studio.state.transport.length_s.toFixed(1))"
    until(page, f"() => {SAYS} === `{place:g} of ${{{length}}} seconds`")


def test_a_sample_is_paused_sought_by_key_and_played_again_at_its_end(sample):
    page = sample
    click(page, "#transport-play")
    until(page, f"() => {PLAYED}.playing === false")
    until(page, "() => document.querySelector('#transport-play').ariaLabel === 'Play'")
    until(page, "() => document.querySelector('#status').textContent.includes('Paused')")
    page.focus("#transport-at")
    page.keyboard.press("Home")
    reached(page, 0)
    for key, place in (("ArrowRight", 1), ("PageUp", 11), ("ArrowLeft", 10), ("PageDown", 0)):
        page.keyboard.press(key)
        reached(page, place)
    page.keyboard.press("ArrowRight")
    reached(page, 1)
    page.keyboard.press(".")
    until(page, f"() => Math.abs({PLAYED}.position_s - 1 - 1 / 30) < 0.005")
    page.keyboard.press("End")
    until(page, f"() => {PLAYED}.ended && {SHOWN.format('#transport-end')}")
    said = "document.querySelector('#transport-end [role=status]').textContent"
    until(page, f"() => {said} === 'The clip has ended. The robot stands.'")
    assert page.evaluate("() => document.querySelector('#transport-end-next').hidden")
    click(page, "#transport-end-again")
    until(page, f"() => {PLAYED}.playing && !{PLAYED}.ended")
    until(page, f"() => !{SHOWN.format('#transport-end')}")
    page.keyboard.press("p")
    until(page, f"() => !{PLAYED}.playing")
    # Whoever is left alone by the transport keeps their shortcuts.
    assert page.evaluate("() => a1studio.state.stopped") is False


def test_the_palette_and_the_keys_play_too(sample, served):
    page = sample
    page.keyboard.press("Control+k")
    page.keyboard.type("speed ½")
    page.keyboard.press("Enter")
    until(page, f"() => {PLAYED}.speed === 0.5")
    until(page, "() => document.querySelector('#transport-speed').value === '0.5'")
    page.keyboard.press("l")
    until(page, "() => document.querySelector('#transport-loop').ariaPressed === 'true'")
    page.keyboard.press("0")
    until(page, f"() => {PLAYED}.playing && {PLAYED}.position_s < 8")
    served.client.post("/api/source", json={"source": "operator:quiet"})
    until(page, "() => document.querySelector('#transport').hidden")
    until(page, "() => document.querySelector('#toasts').textContent === ''")  # of the sample
    page.keyboard.press("p")  # of no use, and no complaint
    assert page.evaluate("() => document.querySelector('#toasts').textContent") == ""


def test_the_next_clip_is_the_next_of_those_that_were_opened(sample, served):
    page = sample
    first = page.evaluate("() => a1studio.state.source")
    click(page, "#sample")
    until(page, f"() => a1studio.state.source !== '{first}' && {SHOWN.format('#transport')}")
    page.focus("#transport-at")
    page.keyboard.press("End")
    click(page, "#transport-end-next")
    until(page, f"() => a1studio.state.source === '{first}' && {SHOWN.format('#transport')}")


@pytest.mark.parametrize("sample", [390], indirect=True)
def test_the_bar_fits_a_telephone(sample):
    page = sample
    boxes = page.evaluate(
        """() => [...document.querySelectorAll('#transport button, #transport input,'
          + '#transport select')].filter((b) => b.offsetParent).map((b) => {
            const { left, right, top, width } = b.getBoundingClientRect();
            return { id: b.id, left, right, top, width };
          })"""
    )
    assert len(boxes) == 7, boxes
    assert all(box["left"] >= 0 and box["right"] <= 390 for box in boxes), boxes
    widths = {box["id"]: box["width"] for box in boxes}
    assert widths["transport-at"] > 200
    tops = [box["top"] for box in boxes if box["id"] != "transport-at"]
    assert max(tops) - min(tops) < 10  # a row
    assert page.evaluate("() => document.documentElement.scrollWidth") <= 390


def test_a_take_being_recorded_is_not_torn_from_the_page(sample, served):
    page = sample
    click(page, "#record")
    until(
        page, "() => a1studio.state.recording && document.querySelector('#transport-at').disabled"
    )
    assert page.evaluate("() => document.querySelector('#transport-play').disabled")
    click(page, "#record")
    until(page, "() => !document.querySelector('#transport-at').disabled")
