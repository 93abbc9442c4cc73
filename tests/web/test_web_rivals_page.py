"""The rivals in a real browser: what each is, one fitted and in use, and the way back."""

from pathlib import Path

import axe
import pytest
from browsing import click, until
from served import Served

from studio.retarget.baselines.registry import RIVALS

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

PLUGIN = Path(__file__).parents[2] / "docs" / "mapper_plugin.py"
NOTE = "document.querySelector('#rival-note').innerText"


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that was begun with a mapper of one's own, of a file."""
    sessions = tmp_path_factory.mktemp("sessions")
    served = Served(sessions, "--source", "operator:walk", "--mapper", f"{PLUGIN}:Bow")
    yield served
    served.end_well()


def test_a_rival_is_chosen_by_what_it_is_drives_and_is_gone_back_from(page, served):
    until(page, f"() => document.querySelectorAll('#rival option').length === {len(RIVALS)}")
    page.evaluate("() => { document.querySelector('#mapper').open = true; }")
    row = f'#mappers li[data-mapper="{PLUGIN}:Bow"]'
    assert until(page, f"() => document.querySelector('{row} button')?.disabled"), "in use"
    assert "stand" not in served.client.get("/api/state").json()["mapper"]["refused"]

    page.select_option("#rival", "kim2020")
    said = page.evaluate(f"() => {NOTE}")
    for words in ("phase, frequency and amplitude", "L4DC 2020", "Limits: One cycle"):
        assert words in said
    axe.find_nothing(page)
    click(page, "#rival-use")
    until(page, "() => /fitted/.test(document.querySelector('#rival-use').innerText)")
    until(page, "() => a1studio.state.mapper.name === 'kim2020'")
    until(page, f"() => /does not map stand and sit/.test({NOTE})")
    until(page, "() => document.querySelector('#rival-use').disabled")
    assert page.evaluate("() => document.querySelector('#mapper-now').innerText") == "kim2020"
    served.wait(lambda state: state["expert"] == "walk" and state["counters"]["falls"] == 0)

    click(page, "#ab-swap")
    until(page, "() => a1studio.state.mapper.name.endsWith(':Bow')")
    click(page, '#mappers li[data-mapper="shipped"] button')
    until(page, "() => a1studio.state.mapper.name === 'shipped'")
    click(page, f"{row} button")
    until(page, "() => a1studio.state.mapper.name.endsWith(':Bow')")
