"""The view's cameras: behind the robot wherever it turns, never under the floor, remembered."""

import math
import time

import pytest
from browsing import drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

INSIDE = "document.querySelector('#view').contentWindow.__viserMutable"
EYE = f"""(() => {{
  const {{ cameraControl: c, camera, nodeRefFromName }} = {INSIDE};
  const world = (v) => nodeRefFromName[''].worldToLocal(v).toArray();
  return [camera.position.clone(), c.getTarget(camera.position.clone())].map(world);
}})()"""
"""Where the camera is, and at what it looks, z up."""
PRESSED = "document.querySelector('.cameras [aria-pressed=true]').dataset.camera"


@pytest.fixture
def page(served, browsing, request):
    """A page on which the figures are drawn, of who wants motion or, by default, does not."""
    motion = getattr(request, "param", "reduce")
    with browsing.page(served, 1000, 700, reduced_motion=motion) as page:
        yield drawn(page)


def yaw(served) -> float:
    w, x, y, z = served.client.get("/api/state").json()["robot"]["base_quat"]
    return math.atan2(2 * (w * z + x * y), 1 - 2 * (y * y + z * z))


def off(page, served) -> float:
    """rad between where the camera looks and where the robot heads, from above."""
    eye, at = page.evaluate(f"() => {EYE}")
    looks = math.atan2(at[1] - eye[1], at[0] - eye[0])
    return abs(math.remainder(looks - yaw(served), math.tau))


@pytest.mark.long
@pytest.mark.parametrize("page", ["no-preference", "reduce"], indirect=True)
def test_the_chase_camera_stays_behind_a_robot_that_turns(page, served):
    page.keyboard.press("5")
    until(page, f"() => {PRESSED} === 'chase'")
    served.client.post("/api/source", json={"source": "operator:turn"})
    begun = yaw(served)
    served.wait(lambda _: abs(math.remainder(yaw(served) - begun, math.tau)) > 1.2, seconds=200.0)
    served.client.post("/api/source", json={"source": "operator:quiet"})
    deadline = time.monotonic() + 60.0
    while off(page, served) > math.pi / 4 + 0.1:  # where no motion is wanted it cuts at 45 degrees
        assert time.monotonic() < deadline, off(page, served)
        time.sleep(0.5)


def test_the_camera_cannot_be_dragged_under_the_floor(page):
    for key in ("1", "2", "5"):
        page.keyboard.press(key)
        page.mouse.move(350, 400)
        page.mouse.down()
        page.mouse.move(350, 80, steps=4)
        page.mouse.up()
        page.evaluate(
            f"""() => {{
              const c = {INSIDE}.cameraControl;
              c.rotate(0, 3, false);
              c.moveTo(0, -4, 0, false);
            }}"""
        )
        # It may look at the floor itself, never from below it.
        until(page, f"() => {EYE}.every(([, , z], i) => (i ? z > -1e-3 : z > 0))")
        page.wait_for_timeout(500)
        assert page.evaluate(f"() => {EYE}")[0][2] > 0.0


def test_a_camera_is_chosen_by_key_and_palette_and_remembered(page):
    page.keyboard.press("6")
    until(page, f"() => {PRESSED} === 'split'")
    page.keyboard.press("Control+k")
    page.keyboard.type("camera: side")
    page.keyboard.press("Enter")
    until(page, f"() => {PRESSED} === 'side'")
    page.reload()
    drawn(page)
    until(page, f"() => {PRESSED} === 'side'")
    eye, _ = page.evaluate(f"() => {EYE}")
    assert eye[1] < -3.0


def test_only_the_simulated_robot_is_there_for_the_chase_camera(page):
    deep = f"(name) => {INSIDE}.nodeRefFromName['/' + name].position.z < -100"
    away = f"() => ['human', 'reference', 'robot'].map({deep}).join()"
    page.keyboard.press("5")
    until(page, f"() => ({away})() === 'true,true,false'")
    page.keyboard.press("1")
    until(page, f"() => ({away})() === 'false,false,false'")
