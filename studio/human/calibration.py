"""Poses seen → who the person is: bone lengths, leg length and heading, only ever refined.

Nothing waits for a calibration: it starts from the template and converges while the person
moves. Neutral is the template; no first pose is ever taken for it.
"""

import math
from collections import deque
from collections.abc import Iterable
from dataclasses import dataclass, field, replace

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.human.posture import SEEN, body_heading, bone_lengths, is_upright, wrapped
from studio.human.skeleton import BONE_LENGTH, BONES, LEG_LENGTH, MIRROR_BONES
from studio.timing import CONTROL_DT

Array = NDArray[np.float64]

_LEG_BONES = np.array([BONES.index(b) for b in ("l_knee", "l_ankle", "r_knee", "r_ankle")])

# Time constants (s) of the heading: a new person is taken up with START_TAU, then as a running
# mean over all that was seen until that is as slow as DRIFT_TAU. Feet and hips turned by TURNED
# are no twist but a turn on the spot: followed until FACED is left.
_START_TAU, _DRIFT_TAU, _QUIET_TAU, _TURNED_TAU = 0.25, 20.0, 2.0, 0.7
_TRAVEL_TAU = 0.5
"""s: nobody twists while crossing a room, they turn."""
_TURNED, _FACED = math.radians(70.0), math.radians(10.0)
_BUTTON_SECONDS = 0.5
_QUIET_MEAN_TAU, _QUIET_DISTANCE, _QUIET_SECONDS = 0.5, 0.04, 0.5


@dataclass(frozen=True, kw_only=True)
class Calibration:
    """What is known of a person; frozen, and replaced as more is seen.

    heading: rad, the way the person faces in the source's world (0 = +x, > 0 to the left).
    bone_length: (18,) m, order of skeleton.BONES. seconds: the weight of what was seen, in seconds
    of motion: 0 for the template, 20 and more only drifts.
    """

    heading: float = 0.0
    bone_length: Array = field(default_factory=BONE_LENGTH.copy)
    seconds: float = 0.0

    @property
    def leg_length(self) -> float:
        """Thigh plus shin, mean of both legs, m."""
        return float(self.bone_length[_LEG_BONES].sum()) / 2.0

    @property
    def scale(self) -> float:
        """Size of the person over the template's, by the legs: for drawing, and for distances."""
        return self.leg_length / LEG_LENGTH

    def mirrored(self) -> "Calibration":
        """The calibration of the mirror image (in the source's x-z plane) of the same person."""
        return replace(self, heading=-self.heading, bone_length=self.bone_length[MIRROR_BONES])


def calibrate(poses: Iterable[HumanPose]) -> Calibration:
    """A calibration robust over all `poses` (a file scanned ahead, thinned or not).

    Bone lengths are medians of what was seen; the heading is the circular median (the direction
    with the least summed angle to all). No poses, or none that shows a body: the template.
    """
    kept = [pose for pose in poses if pose.confidence.max(initial=0.0) >= SEEN]
    if not kept:
        return Calibration()
    lengths, seen = bone_lengths(
        np.stack([pose.joint_pos_w for pose in kept]), np.stack([pose.confidence for pose in kept])
    )
    bone_length = BONE_LENGTH.copy()
    for k in np.flatnonzero(seen.any(axis=0)):
        bone_length[k] = np.median(lengths[seen[:, k], k])
    headings = [body_heading(pose.joint_pos_w, pose.confidence) for pose in kept]
    angles = np.array([angle for angle, weight in headings if weight > 0.05])
    heading = _circular_median(angles) if len(angles) else 0.0
    # However short, a file scanned as a whole is known from its first frame on.
    seconds = max(kept[-1].t - kept[0].t, _DRIFT_TAU)
    return Calibration(heading=heading, bone_length=bone_length, seconds=seconds)


def _circular_median(angles: Array) -> float:
    candidates = angles[:: max(len(angles) // 256, 1)]
    apart = np.abs(np.angle(np.exp(1j * (candidates[:, None] - angles[None, :]))))
    return float(candidates[np.argmin(apart.sum(axis=1))])


class Calibrator:
    """Refines a calibration pose by pose; one per person, called by the loop's thread only.

    Every push is one control period `dt`. A template start glides to the person within a second;
    a scanned start only drifts (τ 20 s, quicker in quiet upright standing, and at once when feet
    and hips have turned further than anyone twists). Repeats of a pose are left out by the caller.
    """

    def __init__(self, start: Calibration | None = None, dt: float = CONTROL_DT) -> None:
        self._start = start or Calibration()
        self._dt = dt
        self.travels = False  # the person crosses the room now
        self.reset()

    def reset(self) -> None:
        """Forget what was seen since the start."""
        self._heading = self._start.heading
        self._bone_length = self._start.bone_length.copy()
        self._seconds = self._start.seconds
        self._recent: deque[float] = deque(maxlen=round(_BUTTON_SECONDS / self._dt))
        self._glide_to: float | None = None
        self._turning = False
        self._still = 0.0
        self._mean: Array | None = None

    @property
    def heading(self) -> float:
        """rad, the heading now."""
        return self._heading

    @property
    def leg_length(self) -> float:
        """Thigh plus shin now, mean of both legs, m."""
        return float(self._bone_length[_LEG_BONES].sum()) / 2.0

    @property
    def bone_length(self) -> Array:
        """(18,) m, the bone lengths now; not to be written to."""
        return self._bone_length

    @property
    def calibration(self) -> Calibration:
        """The calibration now, as a frozen value."""
        return Calibration(
            heading=self._heading, bone_length=self._bone_length.copy(), seconds=self._seconds
        )

    def neutral_now(self) -> bool:
        """The button: the way the person has faced for the last half second is straight ahead.

        The heading glides there within half a second. False, and nothing changes, where nobody's
        hips and shoulders were seen yet.
        """
        if self._recent:
            s = sum(math.sin(a) for a in self._recent)
            c = sum(math.cos(a) for a in self._recent)
            self._glide_to = math.atan2(s, c)
        return bool(self._recent)

    def push(
        self, pose: HumanPose, length: Array | None = None, seen: NDArray[np.bool_] | None = None
    ) -> None:
        """Take in one pose.

        length (18,) m, seen (18,): its `bone_lengths`, where the caller has them.
        """
        if length is None or seen is None:
            length, seen = bone_lengths(pose.joint_pos_w, pose.confidence)
        if not seen.any():
            return
        angle, weight = body_heading(pose.joint_pos_w, pose.confidence)
        if weight > 0.05:
            self._recent.append(angle)
            self._turn(angle, pose)
        error = length - self._bone_length
        if self._seconds > 1.0:
            # Never further than 5 % of the length at a time, so that an outlier moves little.
            cap = 0.05 * self._bone_length
            error = np.minimum(np.maximum(error, -cap), cap)
        gain = self._dt / self._tau()
        self._bone_length = self._bone_length + gain * (seen * error)
        self._seconds += self._dt

    def _turn(self, angle: float, pose: HumanPose) -> None:
        if self._glide_to is not None:
            error = wrapped(self._glide_to - self._heading)
            self._heading = wrapped(self._heading + error * self._dt / 0.12)
            if abs(error) < 1e-3:
                self._glide_to = None
            return
        error = wrapped(angle - self._heading)
        self._turning = abs(error) > (_FACED if self._turning else _TURNED)
        tau = self._tau()
        if self.travels:
            tau = min(tau, _TRAVEL_TAU)
        elif self._turning:
            tau = min(tau, _TURNED_TAU)
        elif self._is_quiet(pose):
            tau = min(tau, _QUIET_TAU)
        self._heading = wrapped(self._heading + error * self._dt / tau)

    def _tau(self) -> float:
        return min(max(self._seconds, _START_TAU), _DRIFT_TAU)

    def _is_quiet(self, pose: HumanPose) -> bool:
        """Standing upright for a while: every joint within some 4 cm of where it has been."""
        if self._mean is None:
            self._mean = pose.joint_pos_w
            return False
        # Against a slow mean, not the last frame: a sensor's jitter is no motion.
        off = pose.joint_pos_w - self._mean
        self._mean = self._mean + (self._dt / _QUIET_MEAN_TAU) * off
        distance = np.sqrt(np.einsum("ji,ji->j", off, off))
        moving = (distance > _QUIET_DISTANCE) & (pose.confidence >= SEEN)
        self._still = 0.0 if moving.any() else self._still + self._dt
        return self._still > _QUIET_SECONDS and is_upright(pose)
