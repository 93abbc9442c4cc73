"""The library in a real Chromium: many takes by mouse and keyboard, the bin, undo, exports."""

import zipfile

import pytest
from acted_takes import acted_take, record
from axe import find_nothing
from browsing import click, drawn, until
from numpy.random import default_rng
from served import Served

from studio.takes.sessions import SessionBook

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

ACTED = ("acted-one", "acted-two", "acted-three")
EXAMPLES = ("example-cmu-march", "example-tilt-and-reach")
LISTED = """() => [...document.querySelectorAll('#library-list li[data-id]')]
  .map((card) => card.dataset.id)"""
CHOSEN = """() => [...document.querySelectorAll('#library-list li.chosen')]
  .map((card) => card.dataset.id).sort()"""
ESCAPE_WHILE_STILL = """() => {
  const event = new KeyboardEvent('keydown', { key: 'Escape', code: 'Escape', bubbles: true });
  return a1studio.still && (document.activeElement.dispatchEvent(event), true);
}"""
"""At once: on a busy machine ticks may be late a moment later, and in doubt Escape is a stop."""
SAID = "() => document.querySelector('#library-says').textContent"


@pytest.fixture(scope="module")
def served(example_sessions):
    """A studio with the two example takes and Ann's three, none of which has a score."""
    sessions = example_sessions
    for i, name in enumerate(ACTED):
        record(acted_take("tilt", default_rng(i), seconds=3.0), sessions, name)
        SessionBook(sessions).add("Ann", name)
    served = Served(sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.fixture
def library(page, served):
    """The library, open, with all five takes, none chosen."""
    places = [one["place"] for one in served.client.get("/api/bin").json()["takes"]]
    if places:
        served.client.post("/api/bin", json={"places": places, "action": "restore"})
    if served.client.get("/api/state").json()["stopped"]:
        served.client.post("/api/reset")
        served.client.post("/api/arm")
    served.client.post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live' && !a1studio.state.stopped")
    page.evaluate("() => document.querySelector('#library')?.close()")
    page.evaluate("() => document.activeElement.blur()")
    page.keyboard.press("u")
    until(page, "() => document.querySelectorAll('#library-list li[data-id]').length === 5")
    until(page, "() => document.querySelectorAll('#library-list em.score').length === 5")
    return page


def card(name: str, what: str = "input") -> str:
    return f'#library-list li[data-id="{name}"] {what}'


def toast(page, words: str) -> None:
    until(page, f"() => [...document.querySelectorAll('.toast')].some("
                f"(t) => t.textContent.includes({words!r}))")  # fmt: skip


def test_takes_have_pictures_and_scores_and_are_found(library):
    until(library, "() => document.querySelectorAll('#library-list img[src]').length === 5")
    shown = library.evaluate("""async () => {
      const images = [...document.querySelectorAll('#library-list img')];
      await Promise.all(images.map((image) => image.decode()));
      return images.map((image) => image.naturalWidth);
    }""")
    assert min(shown) > 0
    assert library.evaluate(SAID) == "5 takes"
    library.fill("#library-find", "ann")
    assert sorted(library.evaluate(LISTED)) == sorted(ACTED)
    library.fill("#library-find", "")
    library.select_option("#library-order", "name")
    click(library, '#library-verdict [data-verdict="kept"]')
    assert library.evaluate(LISTED) == [EXAMPLES[1]]
    click(library, '#library-verdict [data-verdict="all"]')
    assert library.evaluate(SAID) == "5 takes"
    library.select_option("#library-order", "newest")


def test_the_keyboard_chooses_cards_and_escape_lets_go_of_them_first(library):
    order = library.evaluate(LISTED)
    library.focus(card(order[0]))
    library.keyboard.press("Space")
    assert library.evaluate(CHOSEN) == [order[0]]
    library.keyboard.press("ArrowRight")
    assert library.evaluate(CHOSEN) == [order[0]]
    library.keyboard.press("Shift+ArrowRight")
    assert library.evaluate(CHOSEN) == sorted(order[:3])
    library.keyboard.press("Control+a")
    assert library.evaluate(CHOSEN) == sorted(order)
    assert library.inner_text("#library-chosen").startswith("5 selected")
    assert not library.evaluate("() => a1studio.state.stopped")
    until(library, ESCAPE_WHILE_STILL)
    assert library.evaluate(CHOSEN) == []
    assert library.evaluate("() => document.querySelector('#library').open")
    until(library, ESCAPE_WHILE_STILL)
    assert not library.evaluate("() => document.querySelector('#library').open")
    assert not library.evaluate("() => a1studio.state.stopped")
    stops = library.evaluate("""() => [...document.querySelectorAll('#library-list li *')]
      .filter((part) => part.tabIndex === 0).map((part) => part.closest('li').dataset.id)""")
    assert len(set(stops)) == 1  # the Tab key passes a hundred cards at once


def test_escape_stops_a_robot_that_moves(library, served):
    served.client.post("/api/source", json={"source": "operator:walk"})
    # `!still` alone holds where ticks are late, too: here the page must have seen it walk.
    walks = "() => a1studio.state.state === 'walk' && a1studio.silence < 300 && !a1studio.still"
    until(library, walks)
    library.focus(card(EXAMPLES[0]))
    library.keyboard.press("Space")
    library.keyboard.press("Escape")
    served.wait(lambda state: state["stopped"])
    served.client.post("/api/source", json={"source": "operator:quiet"})


def test_many_are_judged_and_thrown_away_and_undo_brings_them_back(library, served):
    for name in (ACTED[0], EXAMPLES[1]):
        library.click(card(name))
    click(library, "#many-reject")
    toast(library, "2 takes rejected")
    until(library, "() => document.querySelectorAll('#library-list li.rejected').length === 2")
    click(library, ".toast:last-child .undo")
    until(library, "() => !document.querySelector('#library-list li.rejected')")
    kept = {t["name"]: t["kept"] for t in served.client.get("/api/takes").json()}
    assert (kept[ACTED[0]], kept[EXAMPLES[1]]) == (None, True)  # each as it was
    # One is gone meanwhile: the other goes on, and it is said which did not.
    served.client.delete(f"/api/takes/{ACTED[0]}")
    click(library, "#many-bin")
    toast(library, f"1 of 2 takes in the bin · {ACTED[0]}: unknown take")
    until(library, "() => document.querySelectorAll('#library-list li[data-id]').length === 3")
    click(library, ".toast:last-child .undo")
    until(library, "() => document.querySelectorAll('#library-list li[data-id]').length === 4")


def test_the_bin_gives_back_and_deletes_for_good_after_asking_once(library, served):
    library.focus(card(library.evaluate(LISTED)[2]))
    library.keyboard.press("Space")
    library.keyboard.press("Shift+End")
    left = 5 - len(library.evaluate(CHOSEN))
    assert left < 4
    library.keyboard.press("Delete")
    until(
        library, f"() => document.querySelectorAll('#library-list li[data-id]').length === {left}"
    )
    click(library, "#library-bin")
    until(library, "() => document.querySelector('#library-title').textContent === 'Bin'")
    until(
        library,
        f"() => document.querySelectorAll('#library-list .binned img[src]').length === {5 - left}",
    )
    library.get_by_role("button", name="Restore").first.click()
    toast(library, "1 take restored")
    until(
        library,
        f"() => document.querySelectorAll('#library-list li[data-id]').length === {4 - left}",
    )
    library.focus("#library-list input")
    library.keyboard.press("Control+a")
    click(library, "#bin-restore")
    toast(library, "restored")
    until(library, "() => document.querySelector('#library-list .empty')")
    click(library, "#library-bin")
    until(library, "() => document.querySelectorAll('#library-list li[data-id]').length === 5")
    served.client.post("/api/takes/many", json={"names": [ACTED[2]], "action": "delete"})
    click(library, "#library-bin")
    library.evaluate("() => document.dispatchEvent(new CustomEvent('takes-changed'))")
    until(library, "() => document.querySelector('#library-list li[data-id]')")
    library.click("#library-list input")
    click(library, "#bin-delete")
    assert library.inner_text("#bin-sure") == "Yes, delete 1 take for good"
    find_nothing(library)
    click(library, "#bin-no")
    assert len(served.client.get("/api/bin").json()["takes"]) == 1
    click(library, "#bin-delete")
    click(library, "#bin-sure")
    toast(library, "1 take deleted for good")
    assert served.client.get("/api/bin").json()["takes"] == []
    record(acted_take("tilt", default_rng(2), seconds=3.0), served.sessions.parent, ACTED[2])
    (served.sessions.parent / ACTED[2]).rename(served.sessions / ACTED[2])


def test_chosen_takes_and_sessions_are_downloaded_as_one_file(library, tmp_path):
    for name in (ACTED[0], EXAMPLES[0]):
        library.click(card(name))
    for select, form, inside in (
        ("#many-export", "bvh", {f"{ACTED[0]}.bvh", f"{EXAMPLES[0]}.bvh"}),
        ("#session-export", "takes", {f"{n}/tape.mcap" for n in ACTED}),
    ):
        if select == "#session-export":
            library.select_option("#library-session", index=1)
        with library.expect_download() as download:
            library.select_option(select, form)
        download.value.save_as(tmp_path / form)
        names = zipfile.ZipFile(tmp_path / form).namelist()
        assert all(any(name.endswith(part) for name in names) for part in inside), names
    library.select_option("#library-session", index=0)


def test_these_are_trained_on_and_no_others(library):
    for name in ACTED[:2]:
        library.click(card(name))
    click(library, "#many-train")
    until(library, "() => !document.querySelector('#library').open")
    until(library, "() => a1studio.state.mode === 'collect'")
    until(library, "() => document.querySelector('#train-takes').textContent.startsWith('2 takes')")
    ticked = library.evaluate("""() => [...document.querySelectorAll('#collected input:checked')]
      .map((box) => box.closest('li').dataset.name).sort()""")
    assert ticked == sorted(ACTED[:2])


def test_axe_finds_nothing_in_the_library(library):
    until(library, "() => document.querySelectorAll('#library-list img[src]').length === 5")
    library.click(card(ACTED[0]))
    find_nothing(library)


def test_a_picture_that_was_not_to_be_had_is_asked_for_again(library):
    refused = []

    def refuse_once(route):
        names = route.request.post_data_json["names"]
        if set(names) & set(refused):
            route.continue_()
            return
        refused.extend(names)
        route.fulfill(json={"pictures": {}, "refused": dict.fromkeys(names, "in the bin")})

    library.reload()
    library.route("**/api/takes/thumbnails", refuse_once)
    drawn(library)
    library.keyboard.press("u")
    until(library, "() => document.querySelectorAll('#library-list img[src]').length === 5")
    assert sorted(refused) == sorted((*ACTED, *EXAMPLES))
    library.unroute("**/api/takes/thumbnails")
