"""A scene on the page: its props are there and move with physics; what is next, done, and best."""

import pytest
from browsing import drawn, until

from studio.live.best_runs import BestRuns

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

PROPS = """() => {
  const { nodeRefFromName } = document.querySelector('#view').contentWindow.__viserMutable;
  const root = nodeRefFromName[''];
  const out = {};
  for (const [name, node] of Object.entries(nodeRefFromName)) {
    if (!/^\\/robot\\/(world\\/props|trunk)/.test(name) || !node) continue;
    node.traverse((mesh) => {
      if (!mesh.getMatrixAt || !mesh.instancesCount) return;
      mesh.updateWorldMatrix(true, false);
      const toView = root.matrixWorld.clone().invert().multiply(mesh.matrixWorld);
      out[name] = Array.from({ length: mesh.instancesCount }, (_, i) =>
        toView.clone().multiply(mesh.getMatrixAt(i).clone()).elements.slice(12, 15));
    });
  }
  return out;
}"""


@pytest.fixture
def page(served, browsing):
    """A page on which the figures are drawn."""
    with browsing.page(served, 1100, 700, reduced_motion="reduce") as page:
        yield drawn(page)


def choose(served, scene: str) -> None:
    answer = served.client.post("/api/scene", json={"scene": scene})
    assert answer.status_code == 200, answer.text


def follow(served, source: str) -> None:
    answer = served.client.post("/api/source", json={"source": source})
    assert answer.status_code == 200, answer.text


DRAWN = f"""() => {{
  const drawn = ({PROPS})();
  const [box, mark] = [drawn['/robot/world/props/moving_0'], drawn['/robot/world/props/still_0']];
  return box && mark && [0, 1].map((i) => box[0][i] - mark[0][i] + [2.3, 0][i]);
}}"""
"""Where the box is drawn, from the mark, whose place is known: the view shifts both."""


def test_a_box_is_drawn_where_it_is_moves_as_it_is_pushed_and_goes(page, served):
    follow(served, "operator:quiet")
    choose(served, "push")
    state = served.wait(lambda state: state["props"])
    x, y = state["props"]["box"][:2]
    near = f"Math.hypot(at[0] - {x}, at[1] - {y})"
    until(page, f"() => {{ const at = ({DRAWN})(); return at && {near} < 0.01; }}")
    follow(served, "operator:walk")
    served.wait(lambda state: state["props"]["box"][0] > x + 0.15, seconds=120.0)
    until(page, f"() => {{ const at = ({DRAWN})(); return at && {near} > 0.1; }}")
    follow(served, "operator:quiet")
    choose(served, "free")
    until(
        page,
        f"() => !Object.keys(({PROPS})()).some((name) => name.startsWith('/robot/world/props'))",
    )


def test_who_comes_late_sees_the_props_of_this_scene_alone(served, browsing):
    choose(served, "slalom")
    choose(served, "fetch")
    follow(served, "operator:quiet")
    with browsing.page(served, 800, 600, reduced_motion="reduce") as page:
        drawn(page)
        count = f"() => Object.entries(({PROPS})()).filter(([n]) => n.includes('/props/'))" + (
            ".flatMap(([, rows]) => rows).length === 4"
        )
        until(page, count)
    choose(served, "free")


def test_steps_are_ticked_as_they_are_done_and_keys_choose(page, served):
    follow(served, "operator:quiet")
    choose(served, "push")
    says = "document.querySelector('#scene-over strong').textContent"
    until(page, f"() => !document.querySelector('#scene-over').hidden && {says}")
    assert page.evaluate(f"() => {says}") == "1 of 2 · Walk to the box."
    body = page.evaluate("() => document.querySelector('#scene-over p').textContent")
    assert body.startswith("March on the spot")
    follow(served, "operator:walk")
    until(page, f"() => {says}.startsWith('2 of 2') || {says}.startsWith('Over')")
    done = "[...document.querySelectorAll('#scene-steps li')].map((li) => li.className)"
    until(page, f"() => {done}[0] === 'done'")
    follow(served, "operator:quiet")
    page.keyboard.press("8")
    until(page, f"() => a1studio.state.progress.step === 0 && {done}[0] === ''")
    page.keyboard.press("9")
    until(page, "() => a1studio.state.scene === 'slalom'")
    until(page, "() => document.querySelector('#scene-now').textContent === 'Slalom'")
    assert page.evaluate("() => document.querySelector('#scene-name').value") == "slalom"
    page.keyboard.press("Control+k")
    page.keyboard.type("free roam")
    page.keyboard.press("Enter")
    until(page, "() => document.querySelector('#scene-over').hidden")


def test_best_runs_are_listed_by_name_whatever_the_name(page, served):
    BestRuns(served.sessions).add("push", "<b>Ann</b>", 150, 20.0, "webcam")
    choose(served, "push")
    rows = "[...document.querySelectorAll('#scene-best li')].map((li) => li.textContent)"
    page.evaluate("() => (document.querySelector('#scene').open = true)")
    until(page, f"() => {rows}.join() === '<b>Ann</b>150 points0:20'")
    page.fill("#scene-person", "Bo")
    page.press("#scene-person", "Enter")
    until(page, "() => a1studio.state.person === 'Bo'")
    drawn_map = """() => {
      const map = document.querySelector('.scene-map');
      const { data } = map.getContext('2d').getImageData(0, 0, map.width, map.height);
      return data.filter((value, i) => i % 4 === 3 && value > 0).length;
    }"""
    until(page, f"() => ({drawn_map})() > 500")
    choose(served, "free")
