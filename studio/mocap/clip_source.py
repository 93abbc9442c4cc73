"""A recorded motion held in memory → a source: what `bvh:` and `frames:` play."""

from dataclasses import replace
from pathlib import Path

import numpy as np

from studio.human.pose import HumanClip, HumanPose
from studio.mocap.between import pose_at
from studio.mocap.source import Source, SourceEnded, thinned
from studio.mocap.source_report import OWN, SourceReport
from studio.robot.a1 import CONTROL_DT

TOLERANCE = 0.5 * CONTROL_DT
"""s: half a control period, so that rounded time stamps do not slip a frame."""


class ClipSource(Source):
    """Plays a HumanClip from its first frame, which is time 0. report: what reading it found."""

    starts_live = True
    seekable = True

    def __init__(
        self, clip: HumanClip, name: str | None = None, report: SourceReport = OWN
    ) -> None:
        self.name = name if name is not None else clip.name
        self.clip, self._report = clip, report
        self._t = clip.t - clip.t[0]
        self.duration: float | None = clip.seconds
        self._given = -1

    def read(self, t: float) -> HumanPose | None:
        """The newest pose with time <= t not given before; SourceEnded once its time is over."""
        assert self.duration is not None
        if t + TOLERANCE >= self.duration - 1e-9:
            raise SourceEnded(self.name)
        newest = int(np.searchsorted(self._t, t + TOLERANCE - 1e-9)) - 1
        if newest > self._given:
            self._given = newest
            return replace(self.clip[newest], t=float(self._t[newest]))
        return None

    def at(self, t: float) -> HumanPose | None:
        """The pose at `t` s into the clip, between frames where need be."""
        return pose_at(t, self._t, self.clip.__getitem__)

    def calibration_poses(self) -> list[HumanPose]:
        """The whole clip, thinned to a few hundred poses."""
        return thinned(self.clip)

    @property
    def label(self) -> str:
        """The kind of file and its name: "bvh brisk walk"."""
        kind, _, path = self.name.partition(":")
        return f"{kind} {Path(path).stem}".replace("_", " ").strip()

    @property
    def report(self) -> SourceReport:
        """What was found in the file."""
        return self._report

    def close(self) -> None:
        """Nothing is held open."""
