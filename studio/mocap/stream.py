"""Frames pushed from a socket's thread → the newest pose, read by the control loop."""

import math
import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from studio.human.pose import Echo, HumanPose
from studio.human.sensor_skeletons import SKELETONS
from studio.human.skeleton import NUM_JOINTS
from studio.mocap.arrivals import ArrivalLog, Arrivals
from studio.mocap.gate import FrameGate
from studio.mocap.raw_frame import FrameRejected
from studio.mocap.source import Source
from studio.mocap.source_report import Refused, SourceReport, report_on


class StreamSource(Source):
    """Sources `stream`, `webcam`: `push` and `new_sender` from any thread, `read` from the loop's.

    Poses are stamped with the seconds since the source was opened, at arrival: a sender's own
    clock may count from anywhere. How old is too old is for `live.safety` to say; see `age`.
    """

    starts_live = False
    duration: float | None = None

    def __init__(
        self, name: str = "stream", *, clock: Callable[[], float] = time.monotonic
    ) -> None:
        self.name = name
        self._clock = clock
        self._opened = clock()
        self._gate = FrameGate(live=True, clock=clock)
        self._lock = threading.Lock()
        self._latest: HumanPose | None = None
        self._sent = 0.0
        self._fresh = False
        self._refused = Refused()
        self._log = ArrivalLog()

    def push(self, raw: object) -> None:
        """Take in one frame: JSON text or bytes, or the decoded object. Raises FrameRejected."""
        try:
            self._admit(self._gate.check, raw)
        except FrameRejected as error:
            self._refuse(str(error))
            raise

    def _refuse(self, why: str) -> None:
        with self._lock:
            self._refused = self._refused.plus(why)

    def _admit(self, check: Callable[[Any], HumanPose], given: object) -> None:
        with self._lock:
            pose = check(given)
            now = self._clock()
            self._log.came(now, pose.t)
            self._latest, self._sent = replace(pose, t=now - self._opened), pose.t
            self._fresh = True

    def new_sender(self) -> None:
        """Another client starts to send: its skeleton and clock are its own."""
        with self._lock:
            self._gate.reset()
            self._log.anew()

    def read(self, t: float) -> HumanPose | None:
        """The newest pose if it was not given before, else None; `t` plays no part."""
        with self._lock:
            if not self._fresh:
                return None
            self._fresh = False
            if self._latest is None:
                return None
            now, arrived = self._clock(), self._opened + self._latest.t
            self._log.read(now, arrived)
            return replace(
                self._latest, echo=Echo(sent=self._sent, waited_ms=1e3 * (now - arrived))
            )

    @property
    def arrivals(self) -> Arrivals | None:
        """Of the last seconds' frames."""
        with self._lock:
            return self._log.summary(self._clock())

    @property
    def age(self) -> float:
        """s since the newest frame arrived; infinite before the first."""
        with self._lock:
            if self._latest is None:
                return math.inf
            return self._clock() - self._opened - self._latest.t

    def calibration_poses(self) -> list[HumanPose]:
        """Nothing to scan ahead: a live person is calibrated as they move."""
        return []

    @property
    def report(self) -> SourceReport:
        """On the skeleton of whoever sends; before the first good frame no joint is found."""
        with self._lock:
            skeleton, refused = self._gate.skeleton, self._refused
        if skeleton is None:
            nothing = np.zeros(NUM_JOINTS, dtype=bool)
            return report_on(SKELETONS["studio"], seen=nothing, refused=refused)
        return report_on(skeleton, refused=refused)

    def close(self) -> None:
        """Forget the last pose."""
        with self._lock:
            self._latest, self._fresh = None, False
