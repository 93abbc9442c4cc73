"""The whole flow behind a source of human motion, without a clock: what every table drives with."""

import logging
import math
import time
from collections.abc import Callable, Iterator
from itertools import islice

from studio.control.drive_command import DriveCommand, PuppeteerConfig
from studio.control.staleness import stale_command
from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.link.link import RobotLink
from studio.mocap.source import Source, poses
from studio.puppeteer import Puppeteer
from studio.takes.tick import Tick
from studio.timing import CONTROL_DT

log = logging.getLogger(__name__)
RISES_WITHIN = 8.0
"""s."""


def met(
    source: Source, config: PuppeteerConfig | None = None, link: RobotLink | None = None
) -> Puppeteer:
    """The whole flow, which has measured the source's person standing quietly. link: as its."""
    return Puppeteer(config, calibrate(source.calibration_poses()), link=link)


def stood_up(puppeteer: Puppeteer) -> Puppeteer:
    """The same, its robot standing: one that is not simulated here rises, which takes seconds.

    StudioError where it does not.
    """
    if puppeteer.link.simulated:
        return puppeteer
    puppeteer.stand_up()
    for _ in range(round(RISES_WITHIN / CONTROL_DT)):
        began = time.perf_counter()
        tick = puppeteer.step()
        if puppeteer.link.ready:
            puppeteer.reset()
            return puppeteer
        if why := puppeteer.link.stopped:
            raise StudioError(f"{puppeteer.link.name} does not stand up: {why}")
        time.sleep(max(0.0, CONTROL_DT - (time.perf_counter() - began)))
    raise StudioError(f"{puppeteer.link.name} did not stand up in {RISES_WITHIN:.0f} s: {tick.why}")


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
        if puppeteer.link.stopped:
            raise StudioError(f"{puppeteer.link.name} stopped: {puppeteer.link.stopped}")
        if realtime:
            time.sleep(max(0.0, began + (k + 1) * CONTROL_DT - time.perf_counter()))
