"""What every source of human motion is: a name, a clock of its own, and `read(t)`.

And what only some can do, with defaults for the others: a new source derives from `Source`.
"""

from collections.abc import Iterator, Sequence
from itertools import count
from typing import Protocol, runtime_checkable

from studio.errors import StudioError
from studio.human.pose import HumanClip, HumanPose
from studio.mocap.arrivals import Arrivals
from studio.mocap.source_report import OWN, SourceReport
from studio.reference.intent import Intent
from studio.timing import CONTROL_HZ


class SourceEnded(Exception):
    """Raised by `Source.read` once the last pose has been given."""


class TakesNoFrames(StudioError):
    """Raised by `Source.push` of a source that frames cannot be sent to."""


@runtime_checkable
class Source(Protocol):
    """Gives human poses over time. Only the control loop's thread calls it, but for `push`,
    `new_sender` and `set_intent`, which any thread may.

    name: the spec it was opened with, as in docs/contract.md. starts_live: armed and live at once
    (files, the operator), or idle until armed (webcam, stream, vmc). duration: s, None if endless.
    tours: nobody drives, it shows what can be done. take: the recorded take that it plays, if any.
    seekable: it has a duration and knows the pose at any time of it (`at`).
    """

    name: str
    starts_live: bool
    duration: float | None
    tours: bool = False
    take: str | None = None
    seekable: bool = False

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
    def label(self) -> str:
        """Source and motion in words, which a take of it is called unless it is given a label."""
        return self.name.replace(":", " ").replace("_", " ")

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

    # What only some sources can do; as it stands here, of one that cannot.

    @property
    def arrivals(self) -> Arrivals | None:
        """How its frames come of late, where somebody sends them as they happen."""
        return None

    def push(self, raw: object) -> None:
        """Take in a frame sent from outside (docs/contract.md): JSON text or bytes, or decoded.

        Raises FrameRejected for one that does not fit, TakesNoFrames where none can be sent.
        """
        raise TakesNoFrames(f"the source is {self.name}: set the source to stream or webcam first")

    def new_sender(self) -> None:
        """Another client starts to send frames: its skeleton and clock are its own."""
        return

    def at(self, t: float) -> HumanPose | None:
        """The pose at `t` s, whatever was read before; None where nobody was seen. StudioError
        for a source that is not `seekable`."""
        raise StudioError(f"{self.name} has no other times to go to: open a file or a take")

    def set_intent(self, intent: Intent) -> None:
        """From now on the person means this, if somebody else says what they mean."""
        return

    def set_style(self, style: str) -> None:
        """Mean walking by another motion (`options.STYLES`), if the person is synthetic."""
        return

    def stand_in(self, *, seed: int, style: str) -> "Source | None":
        """The synthetic person who acts out what is shown (`show`) in the place of this one; None
        where that is for somebody real, or for this one."""
        return None

    def show(self, intent: Intent) -> None:
        """What the person sees meant in this control period, if they can be shown something."""
        return


CALIBRATION_POSES = 300
"""Enough of a recorded person to measure them by."""


def thinned(poses: Sequence[HumanPose] | HumanClip) -> list[HumanPose]:
    """Every n-th pose, so that some CALIBRATION_POSES are left, spread over all."""
    step = max(len(poses) // CALIBRATION_POSES, 1)
    return [poses[i] for i in range(0, len(poses), step)]


def poses(source: Source, begin: float = 0.0) -> Iterator[HumanPose | None]:
    """What a source has to give in each control period from `begin` s on, None where that is
    nothing, to its end."""
    for k in count():
        try:
            yield source.read(begin + k / CONTROL_HZ)
        except SourceEnded:
            return
