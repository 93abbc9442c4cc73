"""What every source of human motion is: a name, a clock of its own, and `read(t)`."""

from collections.abc import Iterator
from itertools import count
from typing import Protocol, runtime_checkable

from studio.human.pose import HumanPose
from studio.mocap.report import OWN, SourceReport


class SourceEnded(Exception):
    """Raised by `Source.read` once the last pose has been given."""


@runtime_checkable
class Source(Protocol):
    """Gives human poses over time. Only the control loop's thread calls it.

    name: the spec it was opened with, as in docs/contract.md. starts_live: armed and live at once
    (files, the operator), or idle until armed (webcam, stream, vmc). duration: s, None if endless.
    """

    name: str
    starts_live: bool
    duration: float | None

    def read(self, t: float) -> HumanPose | None:
        """The newest pose with time <= t (s since the source's start) not given before.

        None when there is nothing new (the caller holds the last). A file's last pose is followed
        by SourceEnded. Half a control period of tolerance absorbs rounded time stamps.
        """
        ...

    def calibration_poses(self) -> list[HumanPose]:
        """Poses that may be scanned ahead to calibrate (a whole file, thinned); [] when live."""
        ...

    @property
    def rejected(self) -> int:
        """Frames refused so far (shape, finite, range, rate, time)."""
        return self.report.refused.frames

    @property
    def report(self) -> SourceReport:
        """What was found in the source, and what was refused so far.

        As it stands here, of one that speaks the canonical skeleton and refuses nothing: a source
        that says otherwise, or none, derives from this class.
        """
        return OWN

    def close(self) -> None:
        """Free what is held; idempotent."""
        ...


def poses(source: Source, rate: float = 30.0) -> Iterator[HumanPose | None]:
    """What a source has to give in each control period, None where that is nothing, to its end."""
    for k in count():
        try:
            yield source.read(k / rate)
        except SourceEnded:
            return
