"""The README's pictures of the page, made anew: `make pictures`.

A server of its own with the example takes, a real Chromium; WebP of the page, animated of 20 s
of a take. A graphics card is not needed, only patience: minutes.
"""

import argparse
import io
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path
from typing import Any

from browsing import Browsing, chromium, click, drawn, until
from PIL import Image
from served import Served

from studio.paths import package_folder
from studio.takes.edit.edits import edit

SIZE = (1400, 860)
TAKE = "example-tilt-and-reach"
TOUR = "operator"
"""Animated; the others make a library of takes."""
DRIVEN = {TOUR: 45, "operator:sit_manipulate": 12, "operator:walk": 12, "operator:crouch": 9}
"""Sources that are recorded, s of each."""
ANIMATED = (20.0, 4.0, 720)
"""s, frames a second, px wide."""
ONLY_FIGURES = """() => {
  for (const node of document.querySelectorAll('.stage-record, .cameras, .looks, #vocabulary'))
    node.hidden = true;
}"""
"""Nothing over the view but captions, which have room over every head then."""

NO_SPARING = """
  const ask = WebGL2RenderingContext.prototype.getParameter;
  WebGL2RenderingContext.prototype.getParameter = function (name) {
    return name === 0x9246 ? "a graphics card" : ask.call(this, name);
  };
"""
"""As with a graphics card: all pixels, and shadows."""


def shot(page: Any, folder: Path, name: str) -> None:
    """The page as it is, once nothing of it is on its way."""
    for _ in range(120):  # what came late on a busy machine comes at once
        if 28 <= float(page.inner_text("#chip-fps b")) <= 32:
            break
        page.wait_for_timeout(250)
    page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
    page.wait_for_timeout(1500)
    image = Image.open(io.BytesIO(page.screenshot(animations="disabled")))
    image.convert("RGB").save(folder / f"{name}.webp", quality=88, method=6)
    print(f"{name}.webp", flush=True)  # noqa: T201


def theme(page: Any, wanted: str) -> None:
    if page.evaluate("() => document.documentElement.dataset.theme") != wanted:
        click(page, "#theme")
        page.wait_for_timeout(1000)


def main_page(page: Any, served: Served, folder: Path) -> None:
    """The three figures, in the dark and in the light."""
    served.client.post("/api/source", json={"source": "operator:manipulate_left"})
    served.wait(lambda _: any(t["robot"]["foot_pos_w"][1][2] > 0.2 for t in latest(served)))
    for look in ("dark", "light"):
        theme(page, look)
        shot(page, folder, f"studio_{look}")
    theme(page, "dark")


def latest(served: Served) -> list[dict]:
    return [served.ticks[i] for i in sorted(served.ticks)[-30:]]


def collecting(page: Any, served: Served, folder: Path) -> None:
    """What is shown to be acted out."""
    served.client.post("/api/source", json={"source": "operator:quiet"})
    click(page, '#mode [data-mode="collect"]')
    until(page, "() => document.querySelectorAll('.bins i').length > 0")
    for task in ("tilt", "tilt", "walk"):
        click(page, f'.choice[data-task="{task}"] button:last-child')
    click(page, "#collect-begin")
    until(page, "() => a1studio.state.collect.phase === 'ready'")
    click(page, '[data-action="go"]')
    until(page, "() => a1studio.state.collect.phase === 'preview' && a1studio.state.collect.t > 2")
    shot(page, folder, "collect_dark")
    served.client.post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live'")
    click(page, '#mode [data-mode="collect"]')
    until(page, "() => a1studio.state.mode === 'collect'")


def reviewing(page: Any, folder: Path) -> None:
    """A take on the bench, its plots below."""
    click(page, f"#collected li[data-name={TAKE}] button")
    until(
        page, "() => a1studio.state.replay && document.querySelector('#bench-align')?.textContent"
    )
    page.focus("#timeline")
    for _ in range(7):
        page.keyboard.press("PageUp")
    page.keyboard.press("j")
    until(page, "() => document.querySelector('#plot canvas')")
    page.select_option("#plot-what", "roll")
    shot(page, folder, "review_dark")
    page.keyboard.press("j")
    click(page, "#bench-close")
    until(page, "() => a1studio.state.mode === 'collect'")


def library(page: Any, served: Served, folder: Path) -> None:
    """All takes with their pictures and scores."""
    served.client.post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live'")
    page.keyboard.press("u")
    until(page, "() => document.querySelectorAll('#library-list em.score').length >= 6")
    theme(page, "light")
    page.keyboard.press("u")
    until(page, "() => document.querySelectorAll('#library-list img[src]').length >= 6")
    shot(page, folder, "library_light")
    page.evaluate("() => document.querySelector('#library').close()")
    theme(page, "dark")


def animation(browsing: Browsing, served: Served, take: str, folder: Path) -> None:
    """The end of a take, frame by frame: as smooth as on a quick machine."""
    seconds, rate, width = ANIMATED
    with browsing.page(served, 1100, 660, script=NO_SPARING, reduced_motion="reduce") as page:
        drawn(page)
        page.evaluate(ONLY_FIGURES)
        served.client.post("/api/source", json={"source": f"take:{take}"})
        served.client.post("/api/mode", json={"mode": "replay"})
        state = served.client.post("/api/transport", json={"action": "pause"}).json()
        start = state["transport"]["length_s"] - seconds
        box = page.locator(".stage").bounding_box()
        frames = []
        for i in range(int(seconds * rate)):
            at = start + i / rate
            move = {"action": "seek", "position_s": at}
            assert served.client.post("/api/transport", json=move).status_code == 200
            until(page, f"() => Math.abs(a1studio.state.transport.position_s - {at}) < 0.02")
            page.wait_for_timeout(300)
            image = Image.open(io.BytesIO(page.screenshot(clip=box))).convert("RGB")
            frames.append(image.resize((width, round(image.height * width / image.width))))
        frames[0].save(
            folder / "studio.webp", save_all=True, append_images=frames[1:],
            duration=round(1000 / rate), loop=0, quality=60, method=4,
        )  # fmt: skip
    size = (folder / "studio.webp").stat().st_size
    assert size < 3e6, f"{size} bytes are too many for a README"
    print(f"studio.webp, {size / 1e6:.1f} MB")  # noqa: T201


def recorded(sessions: Path, source: str) -> str:
    """A take of what a source makes the robot do, made quicker than it plays."""
    before = set(sessions.iterdir())
    subprocess.run(
        [sys.executable, "-m", "studio", "drive", "--source", source, "--seconds",
         str(DRIVEN[source]), "--seed", "3", "--record", "--sessions", str(sessions)],
        check=True, capture_output=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    (take,) = {
        path.name for path in set(sessions.iterdir()) - before if (path / "tape.mcap").exists()
    }
    edit(sessions / take, label=source.removeprefix("operator:").replace("_", " "))
    return take


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--out", type=Path, default=package_folder("web_assets") / "screenshots")
    parser.add_argument("--only", choices=["pictures", "animation"])
    options = parser.parse_args()
    options.out.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory() as root:
        sessions = Path(root) / "sessions"
        shutil.copytree(package_folder("sessions"), sessions)
        takes = {source: recorded(sessions, source) for source in DRIVEN}
        served = Served(sessions, "--source", "operator:quiet")
        try:
            make(served, takes[TOUR], options.out, options.only)
        finally:
            served.end_well()


def make(served: Served, take: str, folder: Path, only: str | None) -> None:
    """All of them, or the pictures or the animation only."""
    with chromium() as browsing:
        if only != "animation":
            with browsing.page(served, *SIZE, script=NO_SPARING, reduced_motion="reduce") as page:
                drawn(page)
                click(page, "#guide .skip-guide")
                main_page(page, served, folder)
                collecting(page, served, folder)
                reviewing(page, folder)
                library(page, served, folder)
        if only != "pictures":
            animation(browsing, served, take, folder)
        assert browsing.problems == [], browsing.problems


if __name__ == "__main__":
    main()
