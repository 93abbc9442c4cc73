"""Collect: a click meant for the stage before does nothing; what is not trained is said."""

import pytest
from browsing import click, drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

LATE = """(action) => new Promise((done) => {
  const button = document.querySelector(`[data-action="${action}"]`);
  new MutationObserver((_, watcher) => {
    if (button.hidden) return;
    watcher.disconnect();
    button.dispatchEvent(new MouseEvent('click', { bubbles: true, detail: 2 }));
    done(document.querySelector('#coach-actions').classList.contains('unmeant'));
  }).observe(button, { attributes: true, attributeFilter: ['hidden'] });
  document.querySelector('[data-action="go"]').click();
})"""
"""Start, and press a button the moment it comes, as a double click does."""
MEANT = "!document.querySelector('#coach-actions').classList.contains('unmeant')"
PAIRS = "[...document.querySelectorAll('#train-pairs li')].map((li) => li.textContent)"


@pytest.mark.long
def test_a_click_that_comes_late_skips_nothing_and_what_is_not_trained_is_said(browsing, served):
    with browsing.page(served, 1100, 700, reduced_motion="reduce") as page:
        drawn(page)
        click(page, '#mode [data-mode="collect"]')
        until(page, "() => document.querySelectorAll('#plan .choice').length === 12")
        click(page, '.choice[data-task="tilt"] button:last-child')
        page.evaluate("() => { document.querySelector('#collect-seconds').value = 8; }")
        click(page, "#collect-begin")
        until(page, "() => a1studio.state.collect.phase === 'ready'")
        assert page.evaluate(LATE, "skip"), "it is seen that it is not meant"
        until(page, f"() => {MEANT}")
        state = served.client.get("/api/state").json()["collect"]
        assert state["phase"] == "preview", state
        page.keyboard.press("v")  # keys are meant
        until(page, "() => ['countdown', 'record'].includes(a1studio.state.collect.phase)")
        until(page, "() => a1studio.state.collect.phase === 'review'")
        page.keyboard.press("k")
        until(page, "() => a1studio.state.collect.phase === 'done'")
        until(page, f"() => {PAIRS}.length === 3")
        stand, walk, sit = page.evaluate(f"() => {PAIRS}")
        assert stand.endswith("pairs")
        assert walk == "Walknot trained: no take shows it"
        assert sit == "Sitnot trained: no take shows it"
        page.evaluate("() => { document.querySelector('#train-steps').value = 20; }")
        click(page, "#train-go")
        says = "document.querySelector('#train-says').textContent"
        until(page, f"() => {says}.startsWith('Trained')")
        told = page.evaluate(f"() => {says}")
        assert told.endswith(": stand · walk, sit not trained: no take shows it")
