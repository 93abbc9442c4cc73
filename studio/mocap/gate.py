"""Raw human frames from outside → HumanPose, or FrameRejected saying what is wrong: the only door.

Whatever comes in, no other exception leaves: the sender may be broken or hostile.
"""

import math
import time
from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.human.posture import SEEN
from studio.human.sensor_skeletons import SKELETONS, SourceSkeleton
from studio.mocap.raw_frame import FrameRejected, arrays_of, parse_frame
from studio.timing import CONTROL_DT

Array = NDArray[np.float64]

MAX_RATE, BURST = 120.0, 30.0
"""Frames a second, and how many may come at once after a pause (a network's hiccup)."""
MAX_COORDINATE = 1e5
"""m from the source's origin, which may be a map's, for joints it says it sees or not."""
MIN_EXTENT, MAX_EXTENT = 0.25, 2.5
"""m, the farthest seen joint from the middle of all: tells millimetres from metres."""
MAX_SPEED = 20.0
"""m/s of any joint; a fast throw's wrist reaches some 15."""
MAX_TIME = 1e11
"""s; the present is 2e9 even for those who count from 1970."""
MAX_AHEAD, MAX_AGE = 1.0, 1.0
"""s by which a frame may run ahead of the clock, or come later than the quickest of its stream."""
_AGE_LEAK = 0.3
ANEW = 5.0
"""s without a good frame after which a stream begins anew: any time stamp, any skeleton."""


class FrameGate:
    """Checks one stream of frames; call `reset` for each new sender. One thread at a time.

    live: frames arrive as they happen, so rate and age are held against the clock; a recorded
    file has neither. clock: seconds, monotonic. time_unit: seconds in the unit of the frames' t.
    """

    def __init__(
        self,
        *,
        live: bool = True,
        clock: Callable[[], float] = time.monotonic,
        time_unit: float = 1.0,
    ) -> None:
        self._live, self._clock, self._time_unit = live, clock, time_unit
        self.rejected = 0
        self.accepted = 0
        self.reset()

    def reset(self) -> None:
        """A new sender: any skeleton, any time stamp; the counters and the rate cap stay."""
        if not hasattr(self, "_tokens"):
            self._tokens, self._refilled = BURST, -math.inf
        self._skeleton: SourceSkeleton | None = None
        self._pose: HumanPose | None = None
        self._at = -math.inf
        self._quickest = math.inf

    @property
    def skeleton(self) -> SourceSkeleton | None:
        """What this sender's frames speak; None before the first good one."""
        return self._skeleton

    def check(self, raw: object) -> HumanPose:
        """The pose in `raw` (JSON text, bytes, or the decoded object); FrameRejected otherwise."""
        return self._counted(self._check, raw)

    def check_pose(self, pose: HumanPose) -> HumanPose:
        """The same for a pose made within the studio, without the way through JSON."""
        return self._counted(self._check_pose, pose)

    def check_made(self, raw: object, make: Callable[[Any], HumanPose]) -> HumanPose:
        """The same where `make` makes a pose of what was sent: at no higher a rate, too."""
        return self._counted(lambda given: self._check_pose(given, make), raw)

    def _counted(self, check: Callable[[Any], HumanPose], given: object) -> HumanPose:
        try:
            pose = check(given)
        except FrameRejected:
            self.rejected += 1
            raise
        self.accepted += 1
        return pose

    def _check(self, raw: object) -> HumanPose:
        now = self._clock()
        self._begin(now)
        frame = parse_frame(raw)
        t = frame.t * self._time_unit
        skeleton = SKELETONS.get(frame.skeleton)
        if skeleton is None:
            known = ", ".join(sorted(SKELETONS))
            raise FrameRejected(f"unknown skeleton {frame.skeleton[:40]!r}; known: {known}")
        if self._skeleton is not None and skeleton is not self._skeleton:
            raise FrameRejected(
                f"the skeleton changed from {self._skeleton.name} to {skeleton.name}: "
                "open a new connection for another sensor"
            )
        positions, confidence = arrays_of(frame, skeleton)
        _check_numbers(t, positions, confidence)
        joint_pos_w, sure = skeleton.to_canonical(positions, confidence)
        pose = self._admit(HumanPose(t=t, joint_pos_w=joint_pos_w, confidence=sure), now)
        self._skeleton = skeleton
        return pose

    def _check_pose(
        self, pose: object, make: Callable[[Any], HumanPose] | None = None
    ) -> HumanPose:
        now = self._clock()
        self._begin(now)
        pose = make(pose) if make else pose
        if not isinstance(pose, HumanPose):
            raise FrameRejected(f"a HumanPose is needed here, not {type(pose).__name__}")
        _check_numbers(pose.t, pose.joint_pos_w, pose.confidence)
        return self._admit(pose, now)

    def _admit(self, pose: HumanPose, now: float) -> HumanPose:
        """What must hold whatever way a pose came: a body, moving as bodies and clocks do."""
        _check_body(pose)
        self._check_time(pose, now)
        self._check_speed(pose)
        self._pose, self._at = pose, now
        return pose

    def _begin(self, now: float) -> None:
        """Live: a token bucket, MAX_RATE frames a second and BURST at once, before any parsing."""
        if not self._live:
            return
        if now - self._at > ANEW:
            # Nothing good for long (a sleeping laptop, a restarted sender): what came then binds
            # nobody now.
            self.reset()
        elapsed = now - self._refilled
        self._tokens = min(BURST, self._tokens + MAX_RATE * max(elapsed, 0.0))
        self._refilled = now
        if self._tokens < 1.0:
            raise FrameRejected(f"more than {MAX_RATE:g} frames a second: send 30")
        self._tokens -= 1.0

    def _check_time(self, pose: HumanPose, now: float) -> None:
        t = pose.t
        if self._pose is not None:
            if t <= self._pose.t:
                raise FrameRejected(
                    f"t = {t:.6g} s is not after the last frame's {self._pose.t:.6g} s: "
                    "time runs forward, or open a new connection"
                )
            if self._live and t - self._pose.t > now - self._at + MAX_AHEAD:
                raise FrameRejected(
                    f"t runs ahead: {t - self._pose.t:.3g} s in {now - self._at:.3g} s of the "
                    "clock; t is in seconds"
                )
        if not self._live:
            return
        # How late the quickest frame came. It may rise as fast as frames come, for senders whose
        # time runs slow; but a frame held up on its way finds the old figure.
        quickest = min(now - t, self._quickest + min(now - self._at, _AGE_LEAK))
        age = now - t - quickest
        if age > MAX_AGE:
            raise FrameRejected(
                f"the frame is {age:.2g} s late; older than {MAX_AGE:g} s is no use"
            )
        self._quickest = quickest

    def _check_speed(self, pose: HumanPose) -> None:
        last = self._pose
        if last is None:
            return
        both = (pose.confidence >= SEEN) & (last.confidence >= SEEN)
        moved = pose.joint_pos_w - last.joint_pos_w
        # A sensor's jitter over a tiny step of time is no speed: count no step as under 1/30 s.
        dt = max(pose.t - last.t, CONTROL_DT)
        speed = math.sqrt(float((np.einsum("ji,ji->j", moved, moved) * both).max())) / dt
        if speed > MAX_SPEED:
            raise FrameRejected(
                f"a joint jumps at {speed:.3g} m/s; people stay under {MAX_SPEED:g} m/s"
            )


def _check_numbers(t: float, positions: Array, confidence: Array | None) -> None:
    """Comparisons are written so that NaN fails them."""
    if not abs(t) <= MAX_TIME:
        raise FrameRejected(f"t = {t:g} is no time in seconds")
    if not (np.abs(positions) <= MAX_COORDINATE).all():
        raise FrameRejected(
            f"a position is not finite or beyond {MAX_COORDINATE:g} m: positions are in metres"
        )
    if confidence is not None and not ((confidence >= 0.0) & (confidence < np.inf)).all():
        raise FrameRejected("a confidence is negative or not finite: 0 (not seen) upwards")


def _check_body(pose: HumanPose) -> None:
    """The seen joints are as far apart as a body's in metres; a frame that shows nobody is fine."""
    seen = pose.confidence >= SEEN
    count = int(seen.sum())
    if count < 4:
        return
    points = pose.joint_pos_w
    away = points - (seen @ points) / count
    extent = math.sqrt(float((np.einsum("ji,ji->j", away, away) * seen).max()))
    if not MIN_EXTENT <= extent <= MAX_EXTENT:
        raise FrameRejected(
            f"the body reaches {extent:.3g} m from its middle; positions are in metres, "
            f"{MIN_EXTENT:g} to {MAX_EXTENT:g} would fit"
        )
