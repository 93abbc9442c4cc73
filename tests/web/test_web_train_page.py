"""Collect's Train: it waits for what it needs, and does not move from under a finger."""

import pytest
from browsing import click, drawn, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]


@pytest.fixture(scope="module")
def served(example_sessions):
    """A server with takes to learn from."""
    served = Served(example_sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


class Held:
    """Requests of a page for this path, which are answered once they are let go."""

    def __init__(self, page, path: str) -> None:
        self._routes, self._held = [], True
        page.route(f"**{path}", self._take)

    def _take(self, route) -> None:
        if self._held:
            self._routes.append(route)
        else:
            route.continue_()

    def let_go(self) -> None:
        self._held = False
        for route in self._routes:
            route.continue_()


@pytest.mark.parametrize("height", [660, 1600])  # px: with the panels scrolled, and all in sight
def test_train_waits_for_the_takes_and_does_not_move_as_the_map_comes(browsing, served, height):
    go = "document.querySelector('#train-go')"
    where = f"() => {go}.getBoundingClientRect().y"
    pairs = "document.querySelectorAll('#train-pairs li').length"
    with browsing.page(served, 1100, height, reduced_motion="reduce") as page:
        takes, covered = Held(page, "/api/takes"), Held(page, "/api/collect/map")
        page.reload()  # it asks as soon as the figures are drawn
        drawn(page)
        click(page, '#mode [data-mode="collect"]')
        until(page, f"() => {go}?.offsetParent")
        assert page.evaluate(f"() => {go}.disabled"), "it would be refused"
        takes.let_go()
        until(page, f"() => !{go}.disabled && {pairs} === 3")
        page.evaluate(f"() => {go}.scrollIntoView({{ block: 'center' }})")
        page.wait_for_timeout(500)  # ms: it is drawn
        before = page.evaluate(where)
        covered.let_go()
        until(page, "() => document.querySelector('#map-states').children.length === 3")
        page.wait_for_timeout(500)
        assert page.evaluate(where) == pytest.approx(before, abs=15.0)
        served.client.post("/api/mode", json={"mode": "live"})
