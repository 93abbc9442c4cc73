"""What a robot that is not simulated here asks of the live loop; for the simulated one, nothing."""

from studio.live.safety import Safety
from studio.puppeteer import Puppeteer
from studio.sources import Source


def begins_live(puppeteer: Puppeteer, source: Source) -> bool:
    """The source drives at once: a robot that can hurt somebody waits until somebody arms."""
    return source.starts_live and puppeteer.link.simulated


def watch(puppeteer: Puppeteer, safety: Safety) -> None:
    """A robot that stopped itself, or was switched on, is stopped here too: reset, then arm."""
    if not safety.stopped and (why := puppeteer.link.stopped):
        safety.stop(why, "robot")


def rest_meanwhile(puppeteer: Puppeteer, safety: Safety, now: float) -> None:
    """A control period of rest, while what is seen is a replay: its line must not be silent."""
    if not puppeteer.link.simulated:
        puppeteer.step(None, safety.command(now, "idle"))
        watch(puppeteer, safety)
