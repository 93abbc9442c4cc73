"""The source of human motion that the loop follows: opened and scanned by any thread, then played
along the loop's clock."""

import logging
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.human.calibration import Calibration, calibrate
from studio.human.pose import HumanPose
from studio.live.timeline import TOLERANCE, Timeline
from studio.robot.a1 import CONTROL_DT
from studio.sources import SOURCES, Source, SourceEnded, open_source

log = logging.getLogger(__name__)
BEFORE = 36
"""Control periods, 1.2 s: by then it is known whether somebody walks, through space, too."""
AWAY = 1.0
"""s without a reading after which a file has been waiting."""


@dataclass(frozen=True, kw_only=True)
class OpenedSource:
    """A source and what scanning it ahead told of the person; made by any thread."""

    source: Source
    calibration: Calibration


def open_for(spec: str, config: PuppeteerConfig, sessions: Path) -> OpenedSource:
    """Open and scan a source, which may take a while: never on the loop's thread.

    spec: of docs/contract.md. sessions: where takes are. StudioError says what would work.
    """
    kind = SOURCES.get(spec.partition(":")[0])
    if kind is not None and kind.batch:
        raise StudioError(
            f"{kind.usage} takes minutes: `a1-studio drive --source {kind.usage} --record` makes a "
            "take of it"
        )
    source = open_source(spec, seed=config.seed, style=config.style, sessions=sessions)
    return OpenedSource(source=source, calibration=calibrate(source.calibration_poses()))


def open_follower(config: PuppeteerConfig, source: Source) -> OpenedSource | None:
    """Who acts out what is shown in place of the source, where it has a `stand_in`."""
    person = source.stand_in(seed=config.seed, style=config.style)
    if person is None:
        return None
    return OpenedSource(source=person, calibration=calibrate(person.calibration_poses()))


class SourceReader:
    """Remembers when the source began, and where in it we are. Only the loop's thread calls it.

    timeline: of a source that is seekable, else None.
    """

    def __init__(self, source: Source) -> None:
        self._refused = 0  # by sources that were since closed
        self._set(source, None)

    def use(self, source: Source, now: float, played: float = 0.0) -> None:
        """Another source, which began `played` s ago."""
        self._set(source, now - played)

    def _set(self, source: Source, since: float | None) -> None:
        self.source, self._from = source, since  # the loop's time at the source's start
        self._read = 0.0  # s since its start when it was last read
        self._ended, self._stamp = False, -TOLERANCE  # s of the last pose given
        self.timeline: Timeline | None = None
        if source.seekable:
            assert source.duration is not None
            self.timeline = Timeline(source.duration)

    @property
    def ended(self) -> bool:
        """Nothing more will come, unless the timeline is moved."""
        return self._ended or (self.timeline is not None and self.timeline.ended)

    @property
    def paused(self) -> bool:
        """The person holds still because the timeline does."""
        return self.timeline is not None and not self.timeline.runs and not self.ended

    def jumped(self) -> bool:
        """Whether the person has to be met anew (`Timeline.jumped`)."""
        return self.timeline is not None and self.timeline.jumped()

    def before(self) -> Iterator[HumanPose]:
        """What the person did just before, period by period, as far as the timeline tells."""
        line = self.timeline
        if line is None:
            return
        for k in range(BEFORE, 0, -1):
            place = line.place - k * line.speed * CONTROL_DT
            pose = self.source.at(place) if place >= 0.0 else None
            if pose is not None:
                yield replace(pose, t=line.passed - k * CONTROL_DT)

    def played(self, now: float) -> float:
        """s since the source began."""
        return self._read if self._from is None else max(now - self._from, self._read)

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

    def read(
        self, now: float, *, held: bool = False, waits: bool = False, loops: bool = True
    ) -> HumanPose | None:
        """What is new by `now`, if anything. A source that fails has ended, never raised.

        held, waits, loops: what has a timeline is held by a stop, waits for the robot, may begin
        anew by itself.
        """
        if self._from is None:
            self._from = now
        # What was read in a late period, before `slip` heard of it, is not taken back.
        self._read = self.played(now)
        if self.timeline is not None:
            away = self._read - self.timeline.passed
            if away > AWAY:  # nobody read it meanwhile, as while a take is replayed: it waited
                self.slip(away)
                self._read = self.timeline.passed
            self.timeline.advance(self._read, held=held, waits=waits, loops=loops)
        if self.ended:
            return None
        try:
            return self._pose(self._read)
        except SourceEnded:
            self._ended = self.timeline is None
            if self.timeline is not None:
                self.timeline.end()
        except Exception:
            log.exception("the source failed; the robot stands")
            self._ended = True
        return None

    def _pose(self, t: float) -> HumanPose | None:
        if self.timeline is None:
            return self.source.read(t)
        if not self.timeline.moved:
            pose = self.source.read(t)
            self._stamp = self._stamp if pose is None else pose.t
            return pose
        # Its own time says nothing any more: the person is as now, and quicker or slower.
        pose = self.source.at(self.timeline.place)
        # Stamps run forward, though the last was a little early or this period follows a late one.
        self._stamp = max(t, self._stamp + TOLERANCE)
        return None if pose is None else replace(pose, t=self._stamp)


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
