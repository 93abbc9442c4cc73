"""How late a camera's frame is, section by section: camera, page, server, reference, screen.

A browser without graphics looks at a film of a synthetic person, numbered by a time code, and
drives; the studio echoes each frame (`web_assets/js/latency.js`). Not in it: a real camera's own
lag, a monitor's, and the 3-D view, which that page does not draw.
"""

import os
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from studio.errors import StudioError
from studio.evaluation.browser import MISSING, Browser, browser, fake_camera, found
from studio.evaluation.options import ScriptOptions
from studio.evaluation.served import PAGE_LIMIT, served
from studio.synthetic.film import film
from studio.training.machine import commit, machine

PERSON = (("quiet", 5.0), ("sit_quiet", 5.0))
"""What stands before the camera, again and again, s."""
PATIENCE = 3.0 * PAGE_LIMIT
"""s for the pose model to load and for the robot to follow."""
_READY = {
    "the page": "window.a1camera",
    "the camera and a person": "a1camera.seen?.world",
    "a robot that follows": "a1camera.driving.stage === 'on' && a1camera.latency.meter?.summary",
}
_OPEN = "for (const d of document.querySelectorAll('details')) d.open = true"
_PRESS = "document.querySelector('#{}').click()"


@dataclass(frozen=True, kw_only=True)
class Options(ScriptOptions):
    """Takes a browser, which shares this machine's cores with the studio."""

    seconds: float = 30.0
    """How long each run is measured."""


def run_latency(options: Options) -> dict[str, Any]:
    """`{"rows": [...]}`: a row for each section and seed, ms p50, p95 and p99, of `frames` frames.

    Besides the sections, which add up frame by frame: "to reference", from the frame to its
    reference beside the model's own time (with the socket's way back); "all", to the screen; and
    "film", by how much later than the promptest the film's pictures came to the page, by their
    numbers alone. Without a browser the one row says so.
    """
    if found() is None:
        return {"rows": [{"case": "skipped", "why": MISSING}]}
    rows = []
    for seed in range(options.seed, options.seed + options.episodes):
        measured = _measured(seed, options.seconds)
        known = {
            "controller": "policy",
            "seed": seed,
            "episodes": 1,
            "frames": measured["frames"],
            "frames_per_second": measured["frames"] / options.seconds,
            "stamped": measured["stamped"],
            "commit": commit(),
            **machine(),
            "load_1min": measured["load_1min"],
        }
        cases = {
            **measured["sections_ms"],
            "to reference": measured["to_reference_ms"],
            "all": measured["total_ms"],
            "film": measured["film_late_ms"],
        }
        rows += [
            {"case": case, **{f"{p}_ms": ms for p, ms in figures.items()}, **known}
            for case, figures in cases.items()
        ]
    return {"rows": rows}


def _measured(seed: int, seconds: float) -> dict[str, Any]:
    """What the page says of its frames over so many seconds, and the load then."""
    with tempfile.TemporaryDirectory(prefix="a1-latency-") as root:
        video = film(Path(root) / "film.mjpeg", *PERSON, seed=seed)
        own = ("--source", "operator:quiet", "--sessions", str(Path(root) / "sessions"))
        with served(*own) as server, browser("about:blank", *fake_camera(video)) as page:
            page.open(server.url.replace("/?", "/camera?"))
            _wait(page, "the page")
            page.evaluate(_PRESS.format("start"))
            _wait(page, "the camera and a person")
            page.evaluate(_PRESS.format("drive"))
            page.evaluate(_OPEN)
            _wait(page, "a robot that follows")
            page.evaluate("a1camera.latency.meter.rows.length = 0")
            time.sleep(seconds)
            measured = page.evaluate("a1camera.latency.meter.summary")
            load = os.getloadavg()[0]
    if not measured or not measured["codes"]:
        raise StudioError(f"no numbered frame was echoed within {seconds:.0f} s")
    return {**measured, "load_1min": round(load, 2)}


def _wait(page: Browser, what: str) -> None:
    deadline = time.perf_counter() + PATIENCE
    while not page.evaluate(f"Boolean({_READY[what]})"):
        if time.perf_counter() > deadline:
            said = page.evaluate("document.querySelector('#said').textContent")
            raise StudioError(f"{what}: not within {PATIENCE:.0f} s ({said or 'no word why'})")
        time.sleep(0.2)
