"""A scene on the page: its props are there, move with physics, and go with it."""

import pytest
from browsing import drawn, until
from served import Served

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

PROPS = """() => {
  const { nodeRefFromName } = document.querySelector('#view').contentWindow.__viserMutable;
  const root = nodeRefFromName[''];
  const out = {};
  for (const [name, node] of Object.entries(nodeRefFromName)) {
    if (!/^\\/(props|robot\\/trunk)/.test(name) || !node) continue;
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


@pytest.fixture(scope="module")
def served(tmp_path_factory):
    """A server that has to end well."""
    served = Served(tmp_path_factory.mktemp("sessions"), "--source", "operator:quiet")
    yield served
    served.end_well()


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
  const [box, mark] = [drawn['/props/moving_0'], drawn['/props/still_0']];
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
    until(page, f"() => {{ const at = ({DRAWN})(); return {near} > 0.1; }}")
    follow(served, "operator:quiet")
    choose(served, "free")
    until(page, f"() => !Object.keys(({PROPS})()).some((name) => name.startsWith('/props'))")


def test_who_comes_late_sees_the_props_of_this_scene_alone(served, browsing):
    choose(served, "slalom")
    choose(served, "fetch")
    follow(served, "operator:quiet")
    with browsing.page(served, 800, 600, reduced_motion="reduce") as page:
        drawn(page)
        count = f"() => Object.entries(({PROPS})()).filter(([n]) => n.startsWith('/props/'))" + (
            ".flatMap(([, rows]) => rows).length === 4"
        )
        until(page, count)
    choose(served, "free")
