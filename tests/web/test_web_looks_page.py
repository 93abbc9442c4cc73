"""Figures shown, as ghosts, hidden, or laid over one another; trails of feet; all remembered."""

import axe
import pytest
from browsing import click, drawn, until

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

INSIDE = "document.querySelector('#view').contentWindow.__viserMutable"
NODE = f"((name) => {INSIDE}.nodeRefFromName[name])"
SEEN = f"""(() => {{
  const out = [];
  {NODE}('/robot/trunk').traverse(({{ material }}) => material && out.push(material.opacity));
  return out[0];
}})()"""
"""How opaque the simulated robot's trunk is."""
PRESSED = "document.querySelector('#figures [data-figure=robot]').getAttribute('aria-pressed')"
NAMED = "document.querySelector('.caption[data-figure=robot]').style.visibility"
GONE = f"({NODE}('/robot').position.z < -100 && {NAMED} === 'hidden')"
TRAIL = f"""((name) => {{
  const mesh = {NODE}(`/${{name}}/world`).children.find((thing) => thing.isMesh);
  const at = mesh?.geometry.attributes.position.array;
  if (!at) return 0;
  return Math.hypot(at[1062] - at[0], at[1063] - at[1]);
}})"""
"""m between both ends of a robot's first foot's trail; 0 where there is none."""


def test_a_robot_is_a_ghost_then_hidden_then_shown_and_it_is_remembered(page):
    robot = '#figures [data-figure="robot"]'
    assert page.evaluate(f"() => {PRESSED} + {SEEN}") == "true1"
    click(page, robot)
    until(page, f"() => {PRESSED} === 'mixed' && {SEEN} < 0.5")
    page.reload()
    axe.put_into(drawn(page))
    until(page, f"() => {PRESSED} === 'mixed' && {SEEN} < 0.5")
    axe.find_nothing(page)
    click(page, robot)
    until(page, f"() => {PRESSED} === 'false' && {GONE}")
    page.reload()
    axe.put_into(drawn(page))
    until(page, f"() => {GONE}")
    click(page, robot)
    until(page, f"() => !{GONE} && {NAMED} === 'visible' && {SEEN} === 1")


def test_the_reference_is_laid_over_the_robot_by_every_camera(page):
    at = f"""((name) => {{
      const [figure, column] = [{NODE}('/' + name), {NODE}(`/${{name}}/caption`).position];
      const {{ x, y, z }} = column.clone().applyQuaternion(figure.quaternion).add(figure.position);
      return [x, y, z - column.z];
    }})"""
    apart = f"Math.hypot(...[0, 1, 2].map((i) => {at}('reference')[i] - {at}('robot')[i]))"
    assert page.evaluate(f"() => {apart}") > 0.5
    click(page, "#besides [data-besides=overlay]")
    for key in "152":
        page.keyboard.press(key)
        until(page, f"() => {apart} < 1e-3 && {at}('robot')[2] === 0")
    click(page, "#besides [data-besides=overlay]")
    until(page, f"() => {apart} > 0.5")
    page.keyboard.press("1")


def test_trails_follow_walking_feet_and_are_gone_with_their_source_and_when_switched_off(
    page, served
):
    served.client.post("/api/source", json={"source": "operator:walk"})
    click(page, "#besides [data-besides=trails]")
    until(page, f"() => {TRAIL}('robot') > 0.5 && {TRAIL}('reference') > 0.5")
    page.reload()
    axe.put_into(drawn(page))
    until(page, f"() => {TRAIL}('robot') > 0.3")
    served.client.post("/api/source", json={"source": "operator:quiet"})
    until(page, f"() => a1studio.state.source === 'operator:quiet' && {TRAIL}('robot') < 0.3")
    click(page, "#besides [data-besides=trails]")
    until(page, f"() => !{NODE}('/robot/world').children.some((thing) => thing.isMesh)")


CAMERAS = f"""(() => new Promise((told) => {{
  const {{ scene }} = {INSIDE};
  const [seen, draws] = [new Set(), scene.onAfterRender];
  if (!Object.hasOwn(scene, 'onAfterRender')) return told(1);
  scene.onAfterRender = (renderer, _, camera) => {{
    seen.add(camera);
    draws.call(scene, renderer, _, camera);
  }};
  setTimeout(() => {{
    scene.onAfterRender = draws;
    told(seen.size);
  }}, 2000);
}}))()"""
"""How many cameras draw the view: nobody but viser where nobody listens."""
LEFT = """((figure) => {
  const { left, right } =
    document.querySelector(`.caption[data-figure=${figure}]`).getBoundingClientRect();
  return (left + right) / 2;
})"""
NOTE = "document.querySelector('#eye figcaption').textContent"


def test_the_robots_eye_is_a_picture_of_its_own_while_it_is_wanted(page):
    assert page.evaluate(f"() => {CAMERAS}") == 1
    click(page, "#besides [data-besides=eye]")
    until(page, f"() => {NOTE} === 'What its front sees'")
    until(page, f"() => {CAMERAS}.then((cameras) => cameras === 2)")
    axe.find_nothing(page)
    for _ in range(2):
        click(page, '#figures [data-figure="robot"]')
    until(page, f"() => {NOTE}.startsWith('The robot is hidden')")
    click(page, '#figures [data-figure="robot"]')
    click(page, "#besides [data-besides=eye]")
    until(page, f"() => {CAMERAS}.then((cameras) => cameras === 1)")


def test_the_split_view_has_a_picture_of_the_person_and_one_of_the_robots(page):
    page.keyboard.press("6")
    middle = "document.querySelector('.stage').clientWidth / 2"
    apart = f"{LEFT}('human') < {middle} && {LEFT}('reference') > {middle}"
    until(page, f"() => {apart} && {LEFT}('robot') > {LEFT}('reference')")
    assert page.evaluate(f"() => {CAMERAS}") == 2
    page.set_viewport_size({"width": 1000, "height": 640})
    until(page, f"() => {apart}")
    page.reload()
    axe.put_into(drawn(page))
    until(page, f"() => {apart}")
    page.keyboard.press("1")
    until(page, f"() => {CAMERAS}.then((cameras) => cameras === 1)")


COVERED = f"""(() => {{
  const box = (node) => node.getBoundingClientRect();
  const captions = [...document.querySelectorAll('.caption')];
  const edges = [...document.querySelectorAll('.stage-record, .cameras, .looks')].map(box);
  const over = (a, b) =>
    a.left < b.right && b.left < a.right && a.top < b.bottom && b.top < a.bottom;
  const frame = document.querySelector('#view');
  const head = {NODE}('/human/caption').position.clone();
  head.z -= 0.12;
  const {{ x, y }} = {NODE}('/human').localToWorld(head).project({INSIDE}.camera);
  const at = box(frame);
  const px = [at.left + (x + 1) / 2 * at.width, at.top + (1 - y) / 2 * at.height];
  const face = {{ left: px[0] - 4, right: px[0] + 4, top: px[1] - 4, bottom: px[1] + 4 }};
  return captions.some((node, i) => node.style.visibility !== 'visible' ||
    [...edges, face, ...captions.slice(i + 1).map(box)].some((other) => over(box(node), other)));
}})()"""
"""Whether a caption lies over another, over buttons, or over the person's face."""


def test_captions_cover_neither_faces_nor_buttons_nor_one_another_in_low_views(page):
    for width, height in ((1280, 720), (1024, 768), (390, 844)):
        page.set_viewport_size({"width": width, "height": height})
        for key in "123":
            page.keyboard.press(key)
            page.wait_for_timeout(300)
            until(page, f"() => !{COVERED}", seconds=60.0)
    page.set_viewport_size({"width": 1300, "height": 800})
    page.keyboard.press("1")


def test_it_says_whether_the_full_or_the_light_view_is_on(page):
    renderer = """() => {
      const context = document.createElement("canvas").getContext("webgl2");
      const named = context.getExtension("WEBGL_debug_renderer_info");
      return context.getParameter(named.UNMASKED_RENDERER_WEBGL);
    }"""
    software = "swiftshader" in page.evaluate(renderer).lower()
    shadows = f"""() => {{
      const lights = [];
      {INSIDE}.scene.traverse((thing) => thing.isLight && lights.push(thing.castShadow));
      return lights.some(Boolean);
    }}"""
    says = "Light view" if software else "Full view"
    until(page, f"() => document.querySelector('#drawn-by').textContent.startsWith('{says}')")
    assert page.evaluate(shadows) is not software
    samples = f"() => {INSIDE}.canvas.getContext('webgl2').getContextAttributes().antialias"
    assert page.evaluate(samples) is not software
    assert page.evaluate(f"() => Boolean({INSIDE}.scene.environment)") is not software
