"""The simulated robot is pushed by the mouse: it moves, the arrow says how hard, a stop lets go."""

import pytest
from browsing import drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

ROBOT = """() => {
  const frame = document.querySelector('#view');
  const { nodeRefFromName: nodes, camera, canvas } = frame.contentWindow.__viserMutable;
  const at = nodes['/robot/caption'].position.clone();
  at.z = a1studio.tick.robot.base_pos[2];
  const point = nodes['/robot'].localToWorld(at).project(camera);
  const { left, top } = frame.getBoundingClientRect();
  return [left + (point.x + 1) / 2 * canvas.clientWidth,
    top + (1 - point.y) / 2 * canvas.clientHeight];
}"""
FORCE = "Math.hypot(...a1studio.state.push)"
ARROW = "document.querySelector('.push-arrow text')"


@pytest.fixture
def page(served, browsing):
    """A page that drives, whose camera looks along x from above."""
    with browsing.page(served, 1000, 700, reduced_motion="reduce") as page:
        drawn(page)
        until(page, "() => document.body.dataset.role === 'drive'")
        page.keyboard.press("4")
        page.wait_for_timeout(500)
        yield page


def drag(page, dx: float, dy: float) -> None:
    """Take hold of the robot and drag; the button stays down."""
    x, y = page.evaluate(ROBOT)
    page.mouse.move(x, y)
    page.mouse.down()
    page.mouse.move(x + dx, y + dy, steps=5)


def test_a_drag_pushes_the_robot_that_way_and_letting_go_ends_it(page, served):
    before = served.client.get("/api/state").json()["robot"]["base_pos"]
    eye = "document.querySelector('#view').contentWindow.__viserMutable.camera.position.toArray()"
    camera = page.evaluate(f"() => {eye}")
    page.keyboard.press("7")
    drag(page, 45, 0)  # seen from above and before it, its left is to the right
    until(page, f"() => {FORCE} > 5")
    assert page.evaluate("() => a1studio.state.push[1]") > 0.0
    until(page, f"() => /^\\d+ N$/.test({ARROW}?.textContent)")
    served.wait(lambda s: s["robot"]["base_pos"][1] > before[1] + 0.02)
    page.mouse.up()
    until(page, f"() => {FORCE} === 0 && !{ARROW}")
    assert page.evaluate(f"() => {eye}") == pytest.approx(camera, abs=1e-3)  # it was not turned
    page.keyboard.press("7")
    served.client.post("/api/scene", json={"scene": "free"})


def test_a_stop_lets_go_in_the_midst_of_a_push(page, served, browsing):
    page.keyboard.down("Shift")
    drag(page, 40, 0)
    until(page, f"() => {FORCE} > 1")
    with browsing.anything_goes():  # a push that is on its way is refused
        page.keyboard.press("Escape")
        until(page, f"() => a1studio.state.stopped && {FORCE} === 0 && !{ARROW}")
        page.wait_for_timeout(700)
    assert page.evaluate(f"() => {FORCE}") == 0
    page.mouse.up()
    page.keyboard.up("Shift")
    assert page.evaluate("() => document.querySelector('#toasts').textContent") == ""
    assert served.client.post("/api/reset").status_code == 200
    assert served.client.post("/api/arm").status_code == 200
