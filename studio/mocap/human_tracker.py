"""The person as last seen: a new pose is checked, and stands in for those that do not come."""

import logging

import numpy as np

from studio.human.pose import HumanPose
from studio.mocap.gate import FrameGate
from studio.mocap.raw_frame import FrameRejected
from studio.mocap.source_report import Refused
from studio.robot.a1 import CONTROL_DT

log = logging.getLogger(__name__)


class HumanTracker:
    """Remembers the last pose and its age. One thread only.

    last: the newest pose that was believed. age: s since then, inf before the first. t: s on the
    source's clock. counters: poses that came, were refused, and periods with a stale one. refused:
    why, of those of this person.
    """

    def __init__(self, *, reuse: float, stale: float) -> None:
        """reuse: s for which the last pose stands in for a missing one. stale: s of age from which
        such a pose is counted as stale."""
        self._reuse, self._stale = reuse, stale
        self.counters = {"frames": 0, "rejected": 0, "stale": 0}
        self._gate = FrameGate(live=False)
        self.forget()

    def forget(self) -> None:
        """Another person, or another source, from here on; the counters go on."""
        self._gate.reset()
        self.last: HumanPose | None = None
        self.age, self.t = np.inf, 0.0
        self.refused = Refused()

    @property
    def now(self) -> HumanPose | None:
        """The pose to go by; None once it is too old to stand in."""
        return self.last if self.age <= self._reuse else None

    def see(self, human: HumanPose | None) -> bool:
        """A control period goes by: keep a pose that a person could have. Is there a new one?"""
        self.t += CONTROL_DT
        self.age += CONTROL_DT
        fresh = human is not None and self._believed(human)
        if fresh:
            assert human is not None
            # Time runs on where none came, and is not taken back by one that is a little late.
            self.last, self.age, self.t = human, 0.0, max(self.t, human.t)
        self.counters["stale"] += bool(not fresh and self._stale < self.age < np.inf)
        return fresh

    def _believed(self, human: HumanPose) -> bool:
        self.counters["frames"] += 1
        try:
            self._gate.check_pose(human)
        except (FrameRejected, AttributeError, TypeError, ValueError) as error:
            self.counters["rejected"] += 1
            self.refused = self.refused.plus(f"at {self.t:.2f} s: {error}")
            log.debug("human pose refused: %s", error)
            return False
        return True
