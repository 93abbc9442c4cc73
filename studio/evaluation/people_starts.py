"""Every clip begun again and again at later seconds → how often the robot falls before its end.

A robot may live through a motion only because of how it came into it: whoever steps before a sensor
does so at any moment.
"""

import logging
from collections.abc import Iterable
from contextlib import closing
from pathlib import Path
from typing import Any

import numpy as np

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.evaluation.behind import drive, met
from studio.evaluation.clips import clips_below
from studio.options import ControllerName, Style
from studio.robot.a1 import CONTROL_DT
from studio.sources import FILES, open_source, spec_of

log = logging.getLogger(__name__)
SHORTEST_S = 1.0
"""A start with less of the clip left than this is none."""


def start_rows(
    folder: Path,
    every: float,
    *,
    style: Style = "march",
    controller: ControllerName | None = None,
    seed: int = 0,
    most: int | None = None,
) -> list[dict[str, Any]]:
    """A row per clip in the folder and below it, at most `most`, and one for all ("all").

    every: s from one start to the next. StudioError where there is no clip, or for `every` of 0 or
    less.
    """
    if not every > 0.0:
        raise StudioError(f"--starts says how many seconds apart starts are: over 0, not {every}")
    clips = clips_below(folder)[:most]
    if not clips:
        raise StudioError(f"no clip ({', '.join(FILES)}) in {folder} or below it")
    config = PuppeteerConfig(style=style, controller=controller, seed=seed)
    rows = []
    for clip in clips:
        falls = [(start, fall_from(clip, start, config)) for start in starts(clip, every)]
        rows.append(_row(clip.relative_to(folder).as_posix(), config, every, falls))
        log.info("%s: %d of %d starts fell", rows[-1]["case"], rows[-1]["fell"], len(falls))
    total = {key: sum(row[key] for row in rows) for key in ("starts", "fell", "seconds")}
    return [*rows, {**rows[0], "case": "all", "fell_at_s": None, **total}]


def starts(clip: Path, every: float) -> Iterable[float]:
    """s into the clip, from 0 on."""
    with closing(open_source(spec_of(clip))) as source:
        duration = source.duration or 0.0
    return [float(t) for t in np.arange(0.0, max(duration - SHORTEST_S, 0.0) + 1e-9, every)]


def fall_from(clip: Path, start: float, config: PuppeteerConfig) -> tuple[float, float | None]:
    """(s driven, s after `start` at which the robot fell, or None), of a clip begun at `start`."""
    with closing(open_source(spec_of(clip), seed=config.seed, style=config.style)) as source:
        ticks = list(drive(met(source, config), source, begin=start))
    if ticks and ticks[-1].fallen:
        fell = (len(ticks) - 1) * CONTROL_DT
        return fell, fell
    return len(ticks) * CONTROL_DT, None


def _row(
    name: str,
    config: PuppeteerConfig,
    every: float,
    falls: list[tuple[float, tuple[float, float | None]]],
) -> dict[str, Any]:
    fell = [round(start + after, 1) for start, (_, after) in falls if after is not None]
    return {
        "case": name,
        "controller": config.controller or "policy",
        "seed": config.seed,
        "every_s": every,
        "starts": len(falls),
        "fell": len(fell),
        "fell_at_s": fell,
        "seconds": sum(driven for _, (driven, _) in falls),
    }
