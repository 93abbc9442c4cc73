"""What is taken out of the page: a take as one HTML file with meshes, a film of the 3-D view."""

import shutil

import pytest
from browsing import click, drawn, until
from served import Served

from studio.paths import package_folder
from studio.takes import commands

pytestmark = [pytest.mark.browser, pytest.mark.timeout(900)]

TAKE = "example-tilt-and-reach"
PIXELS = """async () => {
  const canvas = document.querySelector('#view');
  const copy = document.createElement('canvas');
  [copy.width, copy.height] = [canvas.width, canvas.height];
  const pen = copy.getContext('2d');
  // WebGL's picture can be read only in the frame that draws it.
  document.querySelector('#scrub').dispatchEvent(new Event('input'));
  await new Promise((done) => requestAnimationFrame(done));
  pen.drawImage(canvas, 0, 0);
  const { data } = pen.getImageData(0, 0, copy.width, copy.height);
  const found = { orange: 0, blue: 0, grey: 0 };
  for (let i = 0; i < data.length; i += 4) {
    const [r, g, b, a] = data.subarray(i, i + 4);
    if (a < 250) continue;
    if (r > 1.4 * b) found.orange += 1;
    else if (b > 1.4 * r) found.blue += 1;
    else found.grey += 1;
  }
  return found;
}"""
GO = """(share) => {
  const scrub = document.querySelector('#scrub');
  scrub.value = Math.floor(share * scrub.max);
  scrub.dispatchEvent(new Event('input'));
}"""


@pytest.fixture(scope="module")
def served(example_sessions):
    """A studio with the two example takes."""
    served = Served(example_sessions, "--source", "operator:quiet")
    yield served
    served.end_well()


@pytest.mark.parametrize("scheme", ["dark", "light"])
def test_a_shared_take_opens_from_a_file_with_the_robot_s_meshes(browsing, tmp_path, scheme):
    sessions = package_folder("web_assets").parent / "sessions"
    shutil.copytree(sessions / TAKE, tmp_path / "s" / TAKE)
    file = commands.export_take(tmp_path / "s", TAKE, "html", tmp_path)["file"]
    context = browsing.browser.new_context(
        viewport={"width": 900, "height": 600}, color_scheme=scheme, reduced_motion="reduce"
    )
    page, said = context.new_page(), []
    page.on("console", lambda message: said.append(message.text))
    page.on("pageerror", lambda error: said.append(str(error)))
    page.on("request", lambda r: None if r.url.startswith("file:") else said.append(r.url))
    page.goto(f"file://{file}")
    until(page, "() => document.querySelectorAll('.caption').length === 3")
    assert page.inner_text("#play") == "Play"  # by itself nothing moves where none is wanted
    seconds = page.inner_text("#time").split(" / ")[1]
    assert seconds == "15.70 s"
    page.evaluate(GO, 0.5)
    first = page.evaluate(PIXELS)
    assert min(first.values()) > 1500, first  # three bodies, not lines
    assert page.inner_text("#time").startswith("7.8")
    page.evaluate(GO, 0.75)
    assert page.evaluate(PIXELS) != first
    page.focus("body")
    page.keyboard.press("ArrowRight")
    until(page, f"() => document.querySelector('#scrub').value === '{int(0.75 * 470) + 1}'")
    page.keyboard.press("Space")
    assert page.inner_text("#play") == "Pause"
    until(page, f"() => document.querySelector('#scrub').value > {int(0.75 * 470) + 1}")
    context.close()
    # Of the test's own reading of pixels.
    assert [words for words in said if "stall due to ReadPixels" not in words] == []


DECODED = """async (bytes) => {
  const blob = new Blob([new Uint8Array(bytes)], { type: 'video/webm' });
  const video = Object.assign(document.createElement('video'), { muted: true });
  video.src = URL.createObjectURL(blob);
  document.body.append(video);
  await video.play();
  for (let i = 0; i < 3; i++) await new Promise((done) => video.requestVideoFrameCallback(done));
  const canvas = document.createElement('canvas');
  [canvas.width, canvas.height] = [video.videoWidth, video.videoHeight];
  const pen = canvas.getContext('2d');
  pen.drawImage(video, 0, 0);
  const { data } = pen.getImageData(0, 0, canvas.width, canvas.height);
  video.remove();
  const colours = new Set(new Uint32Array(data.buffer)).size;
  return { wide: canvas.width, high: canvas.height, colours };
}"""


@pytest.fixture(scope="module")
def page(browsing, served):
    """The page, drawn."""
    with browsing.page(served, 1000, 700) as page:
        yield drawn(page)


def film(page, download, tmp_path) -> dict:
    """A film that was saved, as the browser sees it."""
    download.save_as(tmp_path / "film")
    data = (tmp_path / "film").read_bytes()
    assert len(data) > 5000
    return page.evaluate(DECODED, list(data))


def test_the_view_is_filmed_and_the_file_can_be_played(page, tmp_path):
    click(page, "#film")
    until(page, "() => parseInt(document.querySelector('#film').textContent.split('· ')[1]) >= 2")
    assert page.get_attribute("#film", "aria-pressed") == "true"
    with page.expect_download() as download:
        click(page, "#film")
    name = download.value.suggested_filename
    assert name.startswith("a1-studio-20")
    assert name.endswith(".webm")
    seen = film(page, download.value, tmp_path)
    assert seen["wide"] > 400
    assert seen["colours"] > 500  # figures on a glow, not one colour
    assert page.inner_text("#film") == "Film"


def test_a_take_is_filmed_until_it_ends(page, served, tmp_path):
    served.client.patch(f"/api/takes/{TAKE}", json={"trim": [1.0, 3.0]})
    click(page, '#mode [data-mode="collect"]')
    until(page, "() => document.querySelector('#collected li[data-name]')")
    click(page, f'#collected li[data-name="{TAKE}"] button')
    until(
        page, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )
    with page.expect_download() as download:
        page.select_option("#bench-export", "film")
    assert download.value.suggested_filename == f"{TAKE}.webm"
    assert film(page, download.value, tmp_path)["colours"] > 500
    click(page, "#bench-close")


def test_a_browser_that_makes_no_films_says_so(page):
    click(page, '#mode [data-mode="live"]')
    page.evaluate("() => { window.kept = MediaRecorder; delete window.MediaRecorder; }")
    click(page, "#film")
    until(page, "() => document.querySelector('#toasts').textContent.includes('makes no films')")
    assert page.inner_text("#film") == "Film"
    page.evaluate("() => { window.MediaRecorder = window.kept; }")
