"""The whole flow behind a source of human motion, without a clock: what every table drives with."""

import logging
import math
import time
from collections.abc import Callable, Iterator
from itertools import islice

from studio.control.drive_command import DriveCommand, PuppeteerConfig
from studio.control.staleness import stale_command
from studio.human.calibration import calibrate
from studio.mocap.source import Source, poses
from studio.puppeteer import Puppeteer
from studio.takes.tick import Tick
from studio.timing import CONTROL_DT

log = logging.getLogger(__name__)


def met(source: Source, config: PuppeteerConfig | None = None) -> Puppeteer:
    """The whole flow, which has measured the source's person standing quietly."""
    return Puppeteer(config, calibrate(source.calibration_poses()))


def drive(
    puppeteer: Puppeteer,
    source: Source,
    seconds: float = math.inf,
    *,
    begin: float = 0.0,
    guard: Callable[[float], DriveCommand] = stale_command,
    through_falls: bool = False,
    realtime: bool = False,
) -> Iterator[Tick]:
    """Ticks from `begin` s of the source on, until it ends, `seconds` have passed, or the robot has
    fallen (if not to go on `through_falls`).

    guard: what the age of the newest human pose (s, infinite before the first) calls for.
    """
    began = time.perf_counter()
    periods = None if seconds == math.inf else round(seconds / CONTROL_DT)
    for k, human in enumerate(islice(poses(source, begin), periods)):
        tick = puppeteer.step(human, guard)
        yield tick
        if tick.fallen and not through_falls:
            log.info("the robot fell after %.1f s", (k + 1) * CONTROL_DT)
            return
        if realtime:
            time.sleep(max(0.0, began + (k + 1) * CONTROL_DT - time.perf_counter()))
