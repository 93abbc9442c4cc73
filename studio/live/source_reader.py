"""The source of human motion that the loop follows: opened and scanned by any thread, then played
along the loop's clock."""

import logging
from dataclasses import dataclass
from pathlib import Path

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.human.calibration import Calibration, calibrate
from studio.human.pose import HumanPose
from studio.sources import Source, SourceEnded, open_source

log = logging.getLogger(__name__)


@dataclass(frozen=True, kw_only=True)
class OpenedSource:
    """A source and what scanning it ahead told of the person; made by any thread."""

    source: Source
    calibration: Calibration


def open_for(spec: str, config: PuppeteerConfig, sessions: Path) -> OpenedSource:
    """Open and scan a source, which may take a while: never on the loop's thread.

    spec: of docs/contract.md. sessions: where takes are. StudioError says what would work.
    """
    source = open_source(spec, seed=config.seed, style=config.style, sessions=sessions)
    return OpenedSource(source=source, calibration=calibrate(source.calibration_poses()))


def open_follower(config: PuppeteerConfig, source: Source) -> OpenedSource | None:
    """Who acts out what is shown in place of the source, where it has a `stand_in`."""
    person = source.stand_in(seed=config.seed, style=config.style)
    if person is None:
        return None
    return OpenedSource(source=person, calibration=calibrate(person.calibration_poses()))


class SourceReader:
    """Remembers when the source began. Only the loop's thread calls it.

    ended: nothing more will come.
    """

    def __init__(self, source: Source) -> None:
        self.source = source
        self.ended = False
        self._from: float | None = None  # the loop's time at the source's start
        self._refused = 0  # by sources that were since closed

    def use(self, source: Source, now: float, played: float = 0.0) -> None:
        """Another source, which began `played` s ago."""
        self.source, self._from = source, now - played
        self.ended = False

    def played(self, now: float) -> float:
        """s since the source began."""
        return 0.0 if self._from is None else now - self._from

    def slip(self, seconds: float) -> None:
        """The loop dropped periods: a file or the operator waits for the robot.

        They would else hurry past a robot whose time stood still meanwhile: at 20 periods a second
        a march becomes a run that nobody meant. A sensor's people do not wait.
        """
        if self.source.starts_live and self._from is not None:
            self._from += seconds

    def refuse_ended(self, then: str) -> None:
        """StudioError where nothing more will come: what is recorded would be its last pose.

        then: what to do once another source was chosen.
        """
        if self.ended:
            raise StudioError(
                "the source has ended: choose it again, or the synthetic person (operator), then "
                f"{then}"
            )

    def close(self) -> None:
        """Free the source; what it refused stays counted."""
        self._refused += self.source.rejected
        self.source.close()

    @property
    def rejected(self) -> int:
        """Frames refused by this source and those before it."""
        return self.source.rejected + self._refused

    def read(self, now: float) -> HumanPose | None:
        """What is new by `now`, if anything. A source that fails has ended, never raised."""
        if self._from is None:
            self._from = now
        if self.ended:
            return None
        try:
            return self.source.read(now - self._from)
        except SourceEnded:
            self.ended = True
        except Exception:
            log.exception("the source failed; the robot stands")
            self.ended = True
        return None


class ReplacedSource:
    """Remembers the source that collecting has replaced by a person who acts out what is shown."""

    def __init__(self) -> None:
        self._before: tuple[Source, float] | None = None

    def enter(self, source: Source, played: float) -> None:
        """Keep `source`, which began `played` s ago and will go on from there."""
        self._before = source, played

    @property
    def waiting(self) -> Source | None:
        """The source that was replaced, if one was."""
        return None if self._before is None else self._before[0]

    def leave(self) -> tuple[Source, float] | None:
        """What was kept, with its time (s); None when nothing was replaced."""
        before, self._before = self._before, None
        return before

    def forget(self) -> None:
        """Another source was chosen meanwhile."""
        if self._before is not None:
            self._before[0].close()
            self._before = None
