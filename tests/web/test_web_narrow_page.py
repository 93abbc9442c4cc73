"""On a phone, and in low windows: nothing of the page lies over anything else, whatever is done."""

import time

import pytest
from browsing import click, drawn, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

PHONES = ((390, 844), (360, 640), (844, 390), (667, 375))
"""Upright and held sideways."""
LAID_OVER = """() => {
  const names = '.stage-record, .cameras, .looks, #scene-over, #eye, #stopped, #underway, ' +
    '#watching, #asked, #coach, #coach-actions, #bench, .caption, #transport, #vocabulary, ' +
    '.plots, .panels > *';
  const there = [...document.querySelectorAll(names)].filter((node) =>
    node.checkVisibility({ checkVisibilityCSS: true }));
  const sight = document.querySelector('.sight').getBoundingClientRect();
  const phone = innerWidth <= 960;
  const box = (node) => node.getBoundingClientRect();
  const over = (a, b) => a.left < b.right - 1 && b.left < a.right - 1 &&
    a.top < b.bottom - 1 && b.top < a.bottom - 1;
  const name = (node) => node.dataset.figure ?? (node.id || node.className);
  const out = [];
  there.forEach((a, i) => {
    if (phone && !a.closest('.sight') && over(box(a), sight)) out.push(`view, ${name(a)}`);
    for (const b of there.slice(i + 1))
      if (over(box(a), box(b))) out.push(`${name(a)}, ${name(b)}`);
  });
  return out;
}"""
"""Which two lie over one another: all that is in the view or below it."""
CUT = """() => [...document.querySelectorAll('header *, footer *, .sight, #coach-actions button')]
  .filter((node) => node.checkVisibility() && node.getBoundingClientRect().width > 1)
  .filter((node) => { const { left, right } = node.getBoundingClientRect();
    return left < -1 || right > innerWidth + 1; }).map((node) => node.id || node.className)"""
"""What lies beyond the sides of the screen."""
REACHED = """() => {
  const main = document.querySelector('main');
  main.scrollTop = 1e6;
  const last = document.querySelector('.panels').getBoundingClientRect().bottom;
  const first = document.querySelector('footer').getBoundingClientRect().top;
  main.scrollTop = 0;
  return last <= first + 1;
}"""
"""Whether the end of the panels can be scrolled to."""


@pytest.fixture(scope="module")
def page(browsing, narrow):
    with browsing.page(narrow, *PHONES[0], reduced_motion="reduce") as page:
        yield drawn(page)


@pytest.fixture(scope="module")
def narrow(example_sessions):
    served = Served(example_sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


def clear(page, sizes=PHONES) -> None:
    for width, height in sizes:
        page.set_viewport_size({"width": width, "height": height})
        page.wait_for_timeout(600)
        deadline = time.monotonic() + 20.0  # captions look for room, and the view is drawn seldom
        while (over := page.evaluate(LAID_OVER)) and time.monotonic() < deadline:
            time.sleep(0.3)
        assert over == [], (width, height)
        assert page.evaluate(CUT) == []
        assert page.evaluate("() => scrollX + scrollY") == 0


def stopped(page, served, sizes=PHONES) -> None:
    served.client.post("/api/stop")
    until(page, "() => !document.querySelector('#stopped').hidden")
    clear(page, sizes)
    served.client.post("/api/reset")
    served.client.post("/api/arm")
    until(page, "() => document.querySelector('#stopped').hidden")


def scene(served, page, name: str) -> None:
    served.client.post("/api/scene", json={"scene": name})
    hidden = "document.querySelector('#scene-over').hidden"
    until(page, f"() => {hidden} === {str(name == 'free').lower()}")


def test_nothing_lies_over_anything_on_a_phone_live_and_with_a_scene(page, narrow):
    clear(page)
    assert page.evaluate(REACHED)
    stopped(page, narrow)
    click(page, "#besides [data-besides=eye]")
    stopped(page, narrow)
    scene(narrow, page, "push")
    clear(page)
    stopped(page, narrow)
    click(page, "#besides [data-besides=eye]")
    scene(narrow, page, "free")


BESIDE = """() => {
  const box = (what) => document.querySelector(what).getBoundingClientRect();
  const [view, main, stop] = ['.sight', 'main', '#stop'].map(box);
  const low = (what) => [...document.querySelectorAll(what)].filter((node) =>
    node.getBoundingClientRect().bottom > stop.top).length;
  return { high: view.height / main.height, wide: view.width / main.width,
    dialogs: low('dialog[open]'), keys: low('#pad button') };
}"""
"""How much of the room over STOP the view has; how many dialogs and keys of the pad reach below."""


@pytest.mark.long
def test_held_sideways_the_view_stays_beside_whatever_is_scrolled(browsing, served):
    # A server of its own: there this page drives.
    with browsing.page(served, 844, 390, has_touch=True, is_mobile=True) as page:
        drawn(page)
        click(page, "#keys-drive")
        until(page, "() => !document.querySelector('#pad').hidden")
        page.wait_for_timeout(600)
        found = page.evaluate(BESIDE)
        assert found["high"] > 0.99
        assert 0.45 < found["wide"] < 0.55
        assert found["keys"] == 0  # all keys of the pad at once
        clear(page, ((844, 390),))
        page.keyboard.press("Control+k")
        until(page, "() => document.querySelectorAll('#palette li').length > 8")
        assert page.evaluate(BESIDE)["dialogs"] == 0  # STOP stays free
        page.evaluate("() => document.querySelector('#palette').close()")
        assert page.evaluate(REACHED)
        click(page, "#help")
        until(page, "() => document.querySelector('#shortcuts').open")
        assert page.evaluate(BESIDE)["dialogs"] == 0


LOW = ((1280, 800), (1280, 500), (1100, 520), (970, 700))


@pytest.mark.long
def test_the_robots_eye_lies_over_nothing_in_low_windows(page, narrow):
    page.set_viewport_size({"width": 1280, "height": 500})
    click(page, "#besides [data-besides=eye]")
    clear(page, LOW)
    stopped(page, narrow, LOW)
    scene(narrow, page, "push")
    clear(page, LOW)
    stopped(page, narrow, LOW)
    scene(narrow, page, "free")
    click(page, "#besides [data-besides=eye]")


@pytest.mark.long
def test_nothing_lies_over_anything_on_a_phone_collecting_and_under_review(page, narrow):
    page.set_viewport_size({"width": 390, "height": 844})
    click(page, '#mode [data-mode="collect"]')
    until(page, "() => document.querySelectorAll('#plan .choice').length === 12")
    clear(page)
    click(page, '.choice[data-task="walk"] button:last-child')
    page.evaluate("() => { document.querySelector('#collect-seconds').value = 3; }")
    page.evaluate("() => { document.querySelector('main').scrollTop = 1e6; }")
    click(page, "#collect-begin")
    until(page, "() => a1studio.state.collect.phase === 'ready'")
    until(page, "() => document.querySelector('main').scrollTop === 0")
    clear(page)
    click(page, '[data-action="go"]')
    until(page, "() => a1studio.state.collect.phase === 'preview'")
    clear(page)
    click(page, '[data-action="skip"]')
    until(page, "() => a1studio.state.collect.phase === 'review'")
    until(page, "() => !document.querySelector('#coach .quality').hidden")
    clear(page)
    stopped(page, narrow)
    click(page, "#collected li[data-name=example-tilt-and-reach] button")
    until(
        page, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )
    clear(page)
    assert page.evaluate("() => document.querySelector('#view').clientHeight") >= 180
    page.set_viewport_size({"width": 844, "height": 390})
    assert page.evaluate("() => document.querySelector('#timeline').clientHeight") >= 120
    click(page, "#bench-close")
    until(page, "() => a1studio.state.mode === 'collect'")
