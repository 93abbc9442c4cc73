"""The README's pictures of the page, made anew: `make pictures`.

A server of its own with the example takes, a real Chromium; PNG of the page and an animated WebP of
20 s of a take. A graphics card is not needed, only patience: minutes.
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

SIZE = (1400, 860)
TAKE = "example-tilt-and-reach"
TOUR = 45
"""s of the tour that are recorded, the last 20 of which are animated."""
ANIMATED = (20.0, 8.0, 720)
"""s, frames a second, px wide."""


def shot(page: Any, folder: Path, name: str) -> None:
    """The page as it is, once nothing of it is on its way."""
    page.evaluate("() => document.querySelectorAll('.toast').forEach((toast) => toast.remove())")
    page.wait_for_timeout(1500)
    image = Image.open(io.BytesIO(page.screenshot(animations="disabled")))
    image.convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        folder / f"{name}.png", optimize=True
    )
    print(f"{name}.png")  # noqa: T201


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
    until(page, "() => a1studio.state.collect?.phase === 'preview'", seconds=30.0)
    page.wait_for_timeout(2500)
    shot(page, folder, "collect_dark")


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


def library(page: Any, served: Served, folder: Path) -> None:
    """All takes with their pictures and scores."""
    served.client.post("/api/mode", json={"mode": "live"})
    until(page, "() => a1studio.state.mode === 'live'")
    page.keyboard.press("u")
    until(page, "() => document.querySelectorAll('#library-list em.score').length >= 3")
    theme(page, "light")
    page.keyboard.press("u")
    until(page, "() => document.querySelectorAll('#library-list img[src]').length >= 3")
    shot(page, folder, "library_light")
    page.evaluate("() => document.querySelector('#library').close()")
    theme(page, "dark")


def animation(browsing: Browsing, served: Served, take: str, folder: Path) -> None:
    """The end of a take, frame by frame: as smooth as on a quick machine."""
    seconds, rate, width = ANIMATED
    with browsing.page(served, 1100, 640, reduced_motion="reduce") as page:
        drawn(page)
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
            duration=round(1000 / rate), loop=0, quality=60, method=6,
        )  # fmt: skip
    size = (folder / "studio.webp").stat().st_size
    assert size < 3e6, f"{size} bytes are too many for a README"
    print(f"studio.webp, {size / 1e6:.1f} MB")  # noqa: T201


def recorded(sessions: Path) -> str:
    """A take of the tour, made quicker than it plays."""
    subprocess.run(
        [sys.executable, "-m", "studio", "drive", "--source", "operator", "--seconds", str(TOUR),
         "--seed", "3", "--record", "--sessions", str(sessions)],
        check=True, capture_output=True, env={**os.environ, "OMP_NUM_THREADS": "1"},
    )  # fmt: skip
    (take,) = {path.name for path in sessions.iterdir() if (path / "tape.mcap").exists()} - {
        path.name for path in package_folder("sessions").iterdir()
    }
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
        take = recorded(sessions)
        served = Served(sessions, "--source", "operator:quiet")
        with chromium() as browsing:
            if options.only != "animation":
                with browsing.page(served, *SIZE, reduced_motion="reduce") as page:
                    drawn(page)
                    click(page, "#guide .skip-guide")
                    main_page(page, served, options.out)
                    collecting(page, served, options.out)
                    reviewing(page, options.out)
                    library(page, served, options.out)
            if options.only != "pictures":
                animation(browsing, served, take, options.out)
            assert browsing.problems == [], browsing.problems
        served.end_well()


if __name__ == "__main__":
    main()
