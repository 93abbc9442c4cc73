"""The page in a real browser, against a real server: what is drawn, and what each control does."""

import json
import os
import re
import shutil
import signal
import subprocess
import sys
import threading
import time
from pathlib import Path

import httpx
import numpy as np
import pytest

from studio import geometry
from studio.robot import a1
from studio.robot.kinematics import link_frames_w
from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh
from studio.web.follow import HUMAN_SCALE

pytestmark = [pytest.mark.browser, pytest.mark.timeout(600)]

FLAGS = [
    "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist", "--disable-quic", "--no-first-run",
    "--disable-background-networking", "--disable-component-update", "--disable-sync",
]  # fmt: skip
PATIENCE = 120_000
"""ms: software WebGL on a busy machine draws a frame a second."""

# What three.js draws: for each batch, the instances' matrices in the view's own frame (z up).
RENDERED = """() => {
  const m = document.querySelector('#view').contentWindow.__viserMutable;
  const root = m.nodeRefFromName[''];
  const out = {};
  for (const [name, node] of Object.entries(m.nodeRefFromName)) {
    if (!/^\\/(human|reference|robot|contacts)/.test(name) || !node) continue;
    node.traverse((mesh) => {
      if (!mesh.getMatrixAt || !mesh.instancesCount) return;
      mesh.updateWorldMatrix(true, false);
      const toView = root.matrixWorld.clone().invert().multiply(mesh.matrixWorld);
      out[name] = Array.from({ length: mesh.instancesCount }, (_, i) =>
        toView.clone().multiply(mesh.getMatrixAt(i).clone()).elements.slice());
    });
  }
  return out;
}"""


class Served:
    """`a1-studio serve` in a process of its own, and every tick it sent."""

    def __init__(self, sessions: Path, *options: str) -> None:
        environment = {**os.environ, "OMP_NUM_THREADS": "1"}
        self.begun, self.sessions = time.monotonic(), sessions
        self.process = subprocess.Popen(
            [sys.executable, "-m", "studio", "serve", "--port", "0",
             "--sessions", str(sessions), *options],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=environment,
        )  # fmt: skip
        assert self.process.stdout is not None
        self.url = self.process.stdout.readline().strip()
        assert self.url, self.process.stderr.read() if self.process.stderr else ""
        found = re.fullmatch(r"(http://127\.0\.0\.1:(\d+))/\?token=(.+)", self.url)
        assert found, self.url
        self.base, self.port, self.token = found[1], int(found[2]), found[3]
        headers = {"Authorization": f"Bearer {self.token}"}
        self.client = httpx.Client(
            base_url=self.base, headers=headers, timeout=30.0, trust_env=False
        )
        self.ticks: dict[int, dict] = {}
        self._listening = True
        self._thread = threading.Thread(target=self._listen, daemon=True)
        self._thread.start()

    def _listen(self) -> None:
        from websockets.exceptions import ConnectionClosed
        from websockets.sync.client import connect

        headers = {"Authorization": f"Bearer {self.token}"}
        url = f"ws://127.0.0.1:{self.port}/api/ticks"
        with connect(url, additional_headers=headers, proxy=None, max_queue=None) as ws:
            while self._listening:
                try:
                    tick = json.loads(ws.recv(timeout=0.5))
                except TimeoutError:
                    continue
                except ConnectionClosed:
                    return
                self.ticks[tick["index"]] = tick

    def wait(self, true, seconds: float = 60.0) -> dict:
        """The first state for which `true(state)`."""
        deadline = time.monotonic() + seconds
        while True:
            state = self.client.get("/api/state").json()
            if true(state):
                return state
            assert time.monotonic() < deadline, state
            time.sleep(0.1)

    def close(self) -> tuple[int, str]:
        """SIGINT; (exit status, standard error)."""
        self._listening = False
        self._thread.join(timeout=5.0)
        self.client.close()
        self.process.send_signal(signal.SIGINT)
        try:
            _, errors = self.process.communicate(timeout=20.0)
        except subprocess.TimeoutExpired:
            self.process.kill()
            _, errors = self.process.communicate()
        return self.process.returncode, errors


@pytest.fixture(scope="module")
def browser():
    """Debian's Chromium, or Playwright's own."""
    sync_api = pytest.importorskip("playwright.sync_api")
    path = shutil.which("chromium") or shutil.which("google-chrome")
    with sync_api.sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=path, args=FLAGS)
        yield browser
        browser.close()


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that has to end well."""
    served = Served(tmp_path_factory.mktemp("sessions"), "--source", "operator:tilt")
    yield served
    status, errors = served.close()
    assert status == 0, errors
    assert "Traceback" not in errors, errors


@pytest.fixture(scope="module")
def page(browser, served):
    """The page, open, with nothing gone wrong in it by the end."""
    context = browser.new_context(viewport={"width": 760, "height": 560}, color_scheme="dark")
    page = context.new_page()
    problems: list[str] = []
    page.on("pageerror", lambda error: problems.append(str(error)))
    page.on(
        "console",
        lambda message: problems.append(message.text) if message.type == "error" else None,
    )
    page.on(
        "request",
        lambda r: (
            None
            if r.url.startswith((served.base, f"ws://127.0.0.1:{served.port}", "data:", "blob:"))
            else problems.append(f"asked {r.url}")
        ),
    )
    page.set_default_timeout(PATIENCE)
    page.goto(served.url)
    page.wait_for_selector("#veil.gone", state="attached")
    page.problems = problems  # type: ignore[attr-defined]
    yield page
    assert not problems, problems
    context.close()


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


def parts(matrices) -> tuple[np.ndarray, np.ndarray]:
    """Positions (n, 3) and wxyz (n, 4) of column-major matrices (n, 16), scale taken out."""
    m = np.array(matrices).reshape(-1, 4, 4).transpose(0, 2, 1)
    turn = m[:, :3, :3] / np.linalg.norm(m[:, :3, :3], axis=1, keepdims=True)
    return m[:, :3, 3], geometry.quat_from_matrix(turn)


def robot_error(rendered, name, pose) -> float:
    """Largest distance, m or rad, between the drawn links and those of a tick's pose.

    The world is shifted along the floor to follow the robot; everything else must agree.
    """
    pos, quat = link_frames_w(
        np.array(pose["base_pos"]), np.array(pose["base_quat"]), np.array(pose["joint_pos"])
    )
    links = iter_links(rendered, name)
    drawn_pos = np.array([links[link][0] for link in a1.LINKS])
    drawn_quat = np.array([links[link][1] for link in a1.LINKS])
    shift = drawn_pos[0] - pos[0]
    assert shift[2] == pytest.approx(0.0, abs=0.2)
    shift[2] = 0.0
    distance = np.linalg.norm(drawn_pos - pos - shift, axis=-1).max()
    return max(float(distance), float(geometry.quat_angle(drawn_quat, quat).max()))


def iter_links(rendered, name) -> dict[str, tuple[np.ndarray, np.ndarray]]:
    """Each link's drawn position and orientation: a batch's name is its first link's."""
    from studio.sim.visual import link_meshes

    meshes = link_meshes()
    out = {}
    for node, matrices in rendered.items():
        if not node.startswith(f"/{name}/"):
            continue
        first = meshes[node.split("/")[-1]]
        links = [
            link
            for link, mesh in meshes.items()
            if np.array_equal(mesh.vertices, first.vertices)
            and np.array_equal(mesh.faces, first.faces)
        ]
        pos, quat = parts(matrices)
        assert len(links) == len(pos), node
        out |= {link: (pos[i], quat[i]) for i, link in enumerate(links)}
    return out


def human_error(rendered, human) -> float:
    """Largest distance, m in the view, after the turn about z and the shift that fit best."""
    drawn, _ = parts(rendered["/human/joints"])
    joints = HUMAN_SCALE * np.array(human["positions"])
    a, b = joints - joints.mean(0), drawn - drawn.mean(0)
    yaw = np.arctan2((a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]).sum(), (a[:, :2] * b[:, :2]).sum())
    turned = geometry.quat_rotate(np.array([np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)]), a)
    return float(np.linalg.norm(turned - b, axis=-1).max())


def errors(rendered, tick) -> np.ndarray:
    """(3,) of the person, the reference and the robot."""
    return np.array(
        [
            human_error(rendered, tick["human"]),
            robot_error(rendered, "reference", tick["reference"]),
            robot_error(rendered, "robot", tick["robot"]),
        ]
    )


def closest(rendered, ticks) -> dict:
    """The tick whose person is nearest to the drawn one: a robot may rest, a person never does."""
    return min(ticks, key=lambda tick: human_error(rendered, tick["human"]))


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
    assert len(rendered["/contacts"]) == 8


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


def test_a_file_dropped_on_the_page_drives_the_robot(page, served, tmp_path):
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
    assert state["source"].endswith("_quiet.bvh")
    page.wait_for_function(
        "() => document.querySelector('#chip-source').textContent.includes('quiet.bvh')"
    )
    page.evaluate(drop, ["broken.bvh", "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n"])
    page.wait_for_selector("#file-error:not([hidden])")
    assert "line 4" in page.text_content("#file-error")
    page.problems[:] = [p for p in page.problems if "422" not in p]  # as it should be


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


def test_a_second_page_watches_until_it_takes_control(page, served, browser):
    context = browser.new_context(viewport={"width": 600, "height": 400})
    second = context.new_page()
    second.set_default_timeout(PATIENCE)
    second.goto(served.url)
    second.wait_for_selector("#control[data-held=other]")
    second.click("#control")
    second.wait_for_selector("#control[data-held=you]")
    page.wait_for_selector("#control[data-held=other]")
    page.click("#control")
    page.wait_for_selector("#control[data-held=you]")
    context.close()
