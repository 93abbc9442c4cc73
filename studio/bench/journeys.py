"""From opening the page to a first motion of one's own, and to a mapper of one's own: s, clicks.

Each in a browser that has never been here, by what is on the screen alone (`screen.Screen`).
"""

import shutil
import tempfile
import time
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from studio.bench.screen import Screen
from studio.errors import StudioError
from studio.evaluation.browser import MISSING, browser, fake_camera, found
from studio.evaluation.served import PAGE_LIMIT, served
from studio.paths import package_folder
from studio.synthetic.film import film
from studio.synthetic.operator import OperatorSource
from studio.takes.export.bvh import write_bvh
from studio.timing import CONTROL_DT, CONTROL_HZ

PATIENCE = 5.0 * PAGE_LIMIT
"""s for anything to come to the screen at most: a minute for the figures alone where a processor
draws, and training."""
SHOWN = "What physics lets it do"
"""Stands over the simulated robot once it is drawn."""
WALKS, SITS = "Following: walking", "Following: sitting with you"
"""What the page says of a robot that does as the person does."""
CLIP_S = 12.0
CAMERA = (("quiet", 5.0), ("sit_quiet", 7.0))
"""What stands before the camera, again and again, s."""


def keyboard(screen: Screen, _: Path) -> None:
    """Hold W."""
    screen.press("Drive with the keyboard")
    screen.read("march: walk forward")  # the list of keys
    screen.hold("w")
    screen.read(WALKS, SHOWN)
    screen.let_go("w")


def clip(screen: Screen, folder: Path) -> None:
    """Drop a clip in which somebody marches."""
    screen.drop(marching(folder / "my march.bvh"), "Drop a BVH or JSONL file")
    screen.read(WALKS, SHOWN)


def camera(screen: Screen, _: Path) -> None:
    """On the camera's own page: stand there until the ring is full, and sit down. Beside a view
    that the processor draws, only two pictures a second are looked at, which drive nobody."""
    screen.press("Camera on")
    screen.press("Drive the robot")
    screen.read(SITS)


def mapper(screen: Screen, _: Path) -> None:
    """Train on the takes that are there."""
    screen.press("Collect")
    screen.press("Train")
    screen.read("Trained mine")


JOURNEYS: dict[str, Callable[[Screen, Path], None]] = {
    "keyboard": keyboard,
    "clip": clip,
    "camera": camera,
    "mapper": mapper,
}


def journeys(which: Sequence[str] = tuple(JOURNEYS)) -> dict[str, Any]:
    """{name: {seconds, clicks}} since the page was asked for, or {name: {failed}} with what never
    came to the screen; {"skipped": why} without a browser.
    """
    if found() is None:
        return {"skipped": MISSING}
    out = {}
    with tempfile.TemporaryDirectory(prefix="a1-journey-") as root:
        folder = Path(root)
        shutil.copytree(package_folder("sessions"), folder / "sessions")
        own = ("--source", "operator:quiet", "--sessions", str(folder / "sessions"))
        with served(*own) as server:
            for name in which:
                flags = _filmed(folder / "camera.mjpeg") if name == "camera" else ()
                url = server.url.replace("/?", "/camera?") if name == "camera" else server.url
                with browser("about:blank", *flags) as page:
                    began, screen = time.perf_counter(), Screen(page, PATIENCE)
                    page.open(url)
                    out[name] = _went(lambda go=JOURNEYS[name], s=screen: go(s, folder), began)
                    out[name]["clicks"] = screen.clicks
    return out


def _went(journey: Callable[[], None], began: float) -> dict[str, Any]:
    try:
        journey()
    except StudioError as error:
        return {"failed": str(error)}
    return {"seconds": time.perf_counter() - began}


def marching(path: Path) -> Path:
    """A clip of somebody who marches."""
    person = OperatorSource("walk", seed=5)
    times = np.arange(round(CLIP_S * CONTROL_HZ)) * CONTROL_DT
    poses = [pose for t in times if (pose := person.read(float(t)))]
    write_bvh(path, np.array([pose.joint_pos_w for pose in poses]), CONTROL_DT)
    return path


def _filmed(path: Path) -> tuple[str, ...]:
    film(path, *CAMERA)
    return fake_camera(path)
