"""The page in a real browser, against a real server: what is drawn, and what each control does."""

import time

import numpy as np
import pytest
from browsing import drawn, until
from rendered import RENDERED, closest, errors
from served import Served

from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that has to end well."""
    served = Served(tmp_path_factory.mktemp("sessions"), "--source", "operator:tilt")
    yield served
    served.end_well()


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, its view drawn."""
    with browsing.page(served, 760, 560) as page:
        yield drawn(page)


def calm(page, served):
    """Live, armed, in auto, on a moving person; by HTTP, so that each test stands alone."""
    post = served.client.post
    state = served.client.get("/api/state").json()
    if state["source"] != "operator:tilt":
        assert post("/api/source", json={"source": "operator:tilt"}).status_code == 200
    if state["stopped"]:
        assert post("/api/reset").status_code == 200
        assert post("/api/arm").status_code == 200
    post("/api/state", json={"state": "auto"})
    page.wait_for_function("() => !window.a1studio.state.stopped")


def test_all_three_figures_are_drawn_as_the_ticks_say(page, served):
    calm(page, served)
    seen = []
    for _ in range(3):
        for _attempt in range(4):  # a look between two messages of one tick sees half of the next
            rendered = page.evaluate(RENDERED)
            time.sleep(0.3)
            recent = [tick for tick in list(served.ticks.values()) if tick["human"]]
            tick = closest(rendered, recent)
            if errors(rendered, tick).max() < 1e-3:
                break
        # One and the same tick for all three, to the rounding of its JSON and of float32.
        assert errors(rendered, tick).max() < 1e-3, errors(rendered, tick)
        seen.append(tick["index"])
        # The comparison can fail: half a second away is another pose.
        others = [served.ticks.get(tick["index"] + k) for k in (-90, -60, -30, -15)]
        assert max(errors(rendered, other).max() for other in others if other) > 4e-3
        page.wait_for_timeout(1500)
    assert seen == sorted(set(seen)), "the picture stands still"
    assert len(rendered["/human/bones"]) == 18
    assert len(rendered["/reference/contacts"]) == len(rendered["/robot/contacts"]) == 4


def test_webgl_draws_pixels_of_each_figure(page, served):
    calm(page, served)
    colours = page.evaluate(
        """() => {
          const m = document.querySelector('#view').contentWindow.__viserMutable;
          const gl = m.canvas.getContext('webgl2');
          const copy = document.createElement('canvas');
          [copy.width, copy.height] = [m.canvas.width, m.canvas.height];
          const paper = copy.getContext('2d');
          paper.drawImage(m.canvas, 0, 0);
          const d = paper.getImageData(0, 0, copy.width, copy.height).data;
          const n = { webgl: gl !== null && !gl.isContextLost(), orange: 0, blue: 0, drawn: 0 };
          for (let i = 0; i < d.length; i += 4) {
            if (d[i + 3] < 128) continue;
            n.drawn += 1;
            if (d[i] > d[i + 2] + 50) n.orange += 1;
            if (d[i + 2] > d[i] + 50) n.blue += 1;
          }
          return n;
        }"""
    )
    assert colours["webgl"]
    assert colours["orange"] > 120, colours  # the person
    assert colours["blue"] > 40, colours  # the retargeted robot
    assert colours["drawn"] > 1000, colours


def test_the_state_is_switched_by_its_button(page, served):
    calm(page, served)
    page.click("#lock button[data-state=sit]")
    served.wait(lambda s: s["state_lock"] == "sit" and s["state"] == "sit")
    page.wait_for_selector("#lock button[data-state=sit][aria-pressed=true]")
    page.wait_for_function("() => document.querySelector('#state-now').textContent.includes('sit')")
    page.click("#lock button[data-state=auto]")
    served.wait(lambda s: s["state_lock"] == "auto")


def test_a_controller_is_chosen_and_says_what_it_cannot_do(page, served):
    calm(page, served)
    note = "() => document.querySelector('#controller-note').textContent"
    page.wait_for_function(f"() => ({note})().includes('balance')")
    page.select_option("#controller", "pd_playback")
    served.wait(lambda s: s["controller"] == "pd_playback")
    page.wait_for_function(f"() => ({note})().includes('without balance')")
    page.select_option("#controller", "policy")
    served.wait(lambda s: s["controller"] == "policy")


@pytest.mark.parametrize("focus", ["text box", "3-D view"])
def test_escape_stops_wherever_the_focus_is_then_reset_and_arm(page, served, focus):
    calm(page, served)
    if focus == "text box":
        page.click("#label")
        page.keyboard.type("half a la")
        assert page.evaluate("() => document.activeElement.id") == "label"
    else:
        box = page.locator("#view").bounding_box()
        page.mouse.click(box["x"] + 40, box["y"] + box["height"] - 40)
        assert page.evaluate("() => document.activeElement.id") == "view"
    page.keyboard.press("Escape")
    state = served.wait(lambda s: s["stopped"])
    assert "emergency stop" in state["why"]
    page.wait_for_selector("#stopped:not([hidden])")
    page.wait_for_selector("#status[data-kind=stopped]")
    page.click("#reset")
    served.wait(lambda s: s["stopped"] and "is up" in s["why"])
    page.wait_for_selector("#arm.next")
    page.click("#arm")
    served.wait(lambda s: not s["stopped"] and s["armed"])
    page.wait_for_selector("#stopped", state="hidden")
    page.evaluate("() => { document.querySelector('#label').value = ''; }")


def test_the_red_button_stops(page, served):
    calm(page, served)
    page.click("#stop")
    served.wait(lambda s: s["stopped"])


def test_a_file_dropped_on_the_page_drives_the_robot(page, served, browsing, tmp_path):
    calm(page, served)
    source = OperatorSource("quiet", seed=5)
    poses = [pose for k in range(240) if (pose := source.read(k / 30.0))]
    joints = np.array([pose.joint_pos_w for pose in poses])
    write_bvh(tmp_path / "quiet.bvh", joints, 1.0 / 30.0)
    drop = """([name, text]) => {
      const data = new DataTransfer();
      data.items.add(new File([text], name));
      for (const kind of ['dragenter', 'dragover', 'drop'])
        document.querySelector('#view').dispatchEvent(
          new DragEvent(kind, { dataTransfer: data, bubbles: true, cancelable: true }));
    }"""
    page.evaluate(drop, ["quiet.bvh", (tmp_path / "quiet.bvh").read_text()])
    state = served.wait(lambda s: s["source"].startswith("bvh:"))
    assert state["source"].endswith("/quiet.bvh")
    page.wait_for_function(
        "() => document.querySelector('#chip-source').textContent.includes('quiet.bvh')"
    )
    with browsing.expecting("status of 422"):
        page.evaluate(drop, ["broken.bvh", "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n"])
        page.wait_for_selector("#file-error:not([hidden])")
    assert "line 4" in page.text_content("#file-error")


def test_joints_of_a_name_that_nobody_knows_are_said_by_hand(page, served, browsing, tmp_path):
    calm(page, served)
    source = OperatorSource("quiet", seed=5)
    joints = np.array([p.joint_pos_w for k in range(120) if (p := source.read(k / 30.0))])
    write_bvh(tmp_path / "quiet.bvh", joints, 1.0 / 30.0)
    words = {"l_knee": "Zampa", "r_knee": "Altra"}
    strange = (tmp_path / "quiet.bvh").read_text()
    assert all(name in strange for name in words)
    for name, other in words.items():
        strange = strange.replace(f"JOINT {name}\n", f"JOINT {other}\n")
    with browsing.expecting("status of 422"):
        page.set_input_files(
            "#file", {"name": "odd.bvh", "mimeType": "text/plain", "buffer": strange.encode()}
        )
        page.wait_for_selector("#joints[open]")
    assert "knee" in page.text_content("#file-error")
    assert page.locator("#joints .lacks").count() >= 1
    with browsing.expecting("status of 422"):  # one of them is not enough
        page.select_option("#joints [data-joint=l_knee]", "Zampa")
        page.click("#joints-save")
        page.wait_for_selector("#joints-error:not([hidden])")
    page.select_option("#joints [data-joint=r_knee]", "Altra")
    page.click("#joints-save")
    served.wait(lambda s: s["source"].endswith("/odd.bvh"))
    page.wait_for_selector("#joints:not([open])", state="attached")
    until(page, "() => /joints/.test(document.querySelector('#load summary').textContent)")
    assert "up y" in page.text_content("#load summary")
    # The next file of the same joints needs nobody.
    page.set_input_files(
        "#file", {"name": "again.bvh", "mimeType": "text/plain", "buffer": strange.encode()}
    )
    served.wait(lambda s: s["source"].endswith("/again.bvh"))
    page.evaluate("() => { document.querySelector('#load').open = true; }")
    page.click("#joints-edit")
    assert page.input_value("#joints [data-joint=l_knee]") == "Zampa"
    page.click("#joints-close")  # Esc would stop the robot while it moves, and leave this open
    page.wait_for_selector("#joints:not([open])", state="attached")


def test_one_line_always_says_why_nothing_moves(page, served):
    calm(page, served)
    served.client.post("/api/mode", json={"mode": "idle"})
    page.wait_for_function("() => document.querySelector('#status').textContent.includes('Idle')")
    served.client.post("/api/mode", json={"mode": "live"})
    page.wait_for_selector("#status[data-kind=moving]")


def test_a_take_is_recorded_by_its_button(page, served):
    calm(page, served)
    page.click("#record")
    served.wait(lambda s: s["recording"] and s["recording"]["ticks"] > 15)
    page.wait_for_selector("#record[aria-pressed=true]")
    page.click("#record")
    served.wait(lambda s: s["recording"] is None)
    page.wait_for_selector("#takes .name")


def test_dark_and_light_help_and_cameras(page, served):
    calm(page, served)
    page.click("#theme")
    assert page.evaluate("() => document.documentElement.dataset.theme") == "light"
    page.click("#theme")
    assert page.evaluate("() => document.documentElement.dataset.theme") == "dark"
    page.keyboard.press("?")
    page.wait_for_selector("#shortcuts[open]")
    page.click("#shortcuts button")
    inside = "document.querySelector('#view').contentWindow.__viserMutable"
    eye = f"() => {inside}.camera.position.toArray()"
    before = page.evaluate(eye)
    page.click("[data-camera=top]")
    page.wait_for_function(
        f"(before) => Math.hypot(...({eye})().map((v, i) => v - before[i])) > 1", arg=before
    )
    page.click("[data-camera=front]")


def test_a_second_page_watches_until_it_takes_control(page, served, browsing):
    with browsing.page(served, 600, 400) as second:
        second.wait_for_selector("#control[data-held=other]")
        second.click("#control")
        second.wait_for_selector("#control[data-held=you]")
        page.wait_for_selector("#control[data-held=other]")
        page.click("#control")
        page.wait_for_selector("#control[data-held=you]")
