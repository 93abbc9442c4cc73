"""The robot is set down by a press on the floor, while it is stopped or idle, and nowhere else."""

import axe
import pytest
from browsing import click, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

FLOOR = """(([ahead, left]) => {
  const frame = document.querySelector('#view');
  const { nodeRefFromName: nodes, camera, canvas } = frame.contentWindow.__viserMutable;
  const at = nodes['/robot/caption'].position.clone();
  Object.assign(at, { x: at.x + ahead, y: at.y + left, z: 0 });
  const point = nodes['/robot'].localToWorld(at).project(camera);
  const box = frame.getBoundingClientRect();
  return [box.left + (point.x + 1) / 2 * canvas.clientWidth,
    box.top + (1 - point.y) / 2 * canvas.clientHeight];
})"""
"""px on the page of a point on the floor, m ahead and to the left of the robot's column."""
ON = "document.querySelector('#place[aria-pressed=true]')"
TOAST = "document.querySelector('#toasts').textContent"


def pose(served) -> tuple[float, float, float]:
    robot = served.client.get("/api/state").json()["robot"]
    w, _, _, z = robot["base_quat"]
    return (*robot["base_pos"][:2], 2 * z * w)


def press(page, frm, to) -> None:
    page.mouse.move(*page.evaluate(f"(at) => {FLOOR}(at)", frm))
    page.mouse.down()
    page.mouse.move(*page.evaluate(f"(at) => {FLOOR}(at)", to), steps=4)


def test_it_is_set_down_where_the_floor_is_pressed_and_looks_where_that_is_dragged(page, served):
    until(page, "() => document.body.dataset.role === 'drive'")
    page.keyboard.press("4")  # from above
    click(page, "#place")
    until(page, f"() => {TOAST}.includes('Stop the robot')")
    assert not page.evaluate(f"() => {ON}")
    page.keyboard.press("Escape")
    until(page, "() => a1studio.state.needs_reset")
    x, y, _ = pose(served)
    click(page, "#place")
    until(page, f"() => {ON}")
    press(page, [0.5, -0.4], [0.5, 0.1])
    until(page, "() => document.querySelector('.place-mark text')?.textContent === 'looks here'")
    axe.find_nothing(page)
    page.mouse.up()
    until(page, f"() => !{ON} && {TOAST}.includes('Set down at')")
    served.wait(lambda s: s["stopped"] and not s["needs_reset"] and s["robot"]["base_pos"][2] > 0.2)
    assert pose(served) == pytest.approx((x + 0.5, y - 0.4, 1.0), abs=0.12)
    assert not page.evaluate("() => document.querySelector('.place-mark')")
    page.keyboard.press("Home")
    served.wait(lambda s: abs(s["robot"]["base_pos"][0]) + abs(s["robot"]["base_pos"][1]) < 0.1)
    assert pose(served)[2] == pytest.approx(0.0, abs=0.1)
    served.client.post("/api/arm")


def test_the_horizon_is_no_floor_and_idle_is_enough(page, served):
    served.client.post("/api/mode", json={"mode": "idle"})
    page.keyboard.press("1")
    until(page, "() => a1studio.state.mode === 'idle'")
    before = pose(served)
    click(page, "#place")
    page.mouse.move(60, 160)
    page.mouse.down()
    page.mouse.up()
    until(page, f"() => {TOAST}.includes('not so far away')")
    assert page.evaluate(f"() => {ON}")  # for another try
    assert pose(served) == pytest.approx(before, abs=0.02)
    press(page, [0.6, 0.0], [0.6, 0.0])
    page.mouse.up()
    served.wait(lambda s: s["robot"]["base_pos"][0] > before[0] + 0.3)
    served.client.post("/api/mode", json={"mode": "live"})
