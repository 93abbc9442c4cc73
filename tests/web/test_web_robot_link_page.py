"""A robot behind a link, on the page: that it is one, what it does, and that it is gone."""

import pytest
from browsing import click, drawn, until
from robots import end, robot
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

SAYS = "document.querySelector('#chip-robot b').textContent"
CAPTION = "document.querySelector('.caption[data-figure=robot] b').textContent"


@pytest.mark.long
def test_a_robot_behind_a_link_is_named_and_its_state_is_said(browsing, tmp_path):
    body, port = robot()
    served = Served(tmp_path, "--source", "operator:crouch", "--robot", f"udp:127.0.0.1:{port}")
    try:
        with browsing.page(served, 1200, 700, reduced_motion="reduce") as page:
            drawn(page)
            until(page, f"() => {SAYS} === 'Robot: limp: switched on'")
            until(page, f"() => {CAPTION} === 'Robot behind a link'")
            title = page.get_attribute("#chip-robot", "title")
            assert f"udp:127.0.0.1:{port}: references are sent to it" in title
            click(page, "#reset")
            click(page, "#arm")
            until(page, f"() => {SAYS} === 'Robot: following'")
            assert page.get_attribute("#chip-robot", "data-link") == "up"
            click(page, "#stop")
            until(page, f"() => {SAYS} === 'Robot: limp: stopped'")
            end(body)
            until(page, f"() => /silent for [0-9.]+ s/.test({SAYS})")
            assert page.get_attribute("#chip-robot", "data-link") == "down"
    finally:
        served.close()
        end(body)


def test_the_robot_simulated_here_has_no_chip_of_a_link(browsing, served):
    with browsing.page(served, 1200, 700) as page:
        drawn(page)
        until(page, "() => a1studio.state")
        assert page.evaluate("() => document.querySelector('#chip-robot').hidden")
