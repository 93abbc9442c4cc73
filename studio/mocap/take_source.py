"""take:NAME: the human of a recorded take as a source, through the same flow as the first time."""

from itertools import pairwise
from pathlib import Path

import numpy as np

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.posture import SEEN
from studio.human.sensor_skeletons import SKELETONS
from studio.mocap.between import pose_at
from studio.mocap.source import Source, SourceEnded, thinned
from studio.mocap.source_report import SourceReport, report_on
from studio.robot import a1
from studio.takes.export.formats import tick_range
from studio.takes.session_library import SessionLibrary


class TakeSource(Source):
    """Replays a take's human poses (within its trim), each when it was first used."""

    starts_live = True
    seekable = True

    def __init__(self, name: str, sessions: Path) -> None:
        take = SessionLibrary(sessions).read(name)
        start, end = tick_range(take)
        used = [n for n in take.human_tick.tolist() if start <= n < end]
        self._due = [(n - start) * a1.CONTROL_DT for n in used]
        self._poses: list[HumanPose] = []
        for due, n in zip(self._due, used):
            pose = take.ticks[n].human
            assert pose is not None
            self._poses.append(_at(pose, due))
        if not self._poses:
            raise StudioError(f"take {name} has no human motion to replay")
        self._restore_clock([take.ticks[n].human for n in used])
        self.name, self.take = f"take:{name}", name
        self.duration: float | None = (end - start) * a1.CONTROL_DT
        self._next = 0
        seen = np.max([pose.confidence for pose in self._poses], axis=0) >= SEEN
        self._report = report_on(SKELETONS["studio"], seen=seen)

    def _restore_clock(self, originals: list[HumanPose | None]) -> None:
        """The source's own spacing of its poses, where it never ran backwards."""
        own = [pose.t for pose in originals if pose is not None]
        if all(later > earlier for earlier, later in pairwise(own)):
            shift = self._due[0] - own[0]
            self._poses = [_at(pose, t + shift) for pose, t in zip(self._poses, own)]

    def read(self, t: float) -> HumanPose | None:
        """The newest pose used by `t` s into the take and not given before."""
        assert self.duration is not None
        if self._next >= len(self._poses) and t + 0.5 * a1.CONTROL_DT >= self.duration:
            raise SourceEnded(self.name)
        newest = None
        while self._next < len(self._poses) and self._due[self._next] <= t + 0.5 * a1.CONTROL_DT:
            newest = self._poses[self._next]
            self._next += 1
        return newest

    def at(self, t: float) -> HumanPose | None:
        """The pose at `t` s into the take, between those used where need be."""
        return pose_at(t, np.array(self._due), self._poses.__getitem__)

    def calibration_poses(self) -> list[HumanPose]:
        """The take, thinned."""
        return thinned(self._poses)

    @property
    def report(self) -> SourceReport:
        """Which joints are ever seen in the take."""
        return self._report

    def close(self) -> None:
        """Nothing is held."""


def _at(pose: HumanPose, t: float) -> HumanPose:
    return HumanPose(t=t, joint_pos_w=pose.joint_pos_w, confidence=pose.confidence)
