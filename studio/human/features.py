"""Human poses, one a control period → the causal triplet (q, q̇, q̈) that selector and mapper read.

q is the person on the template's body in the heading frame (`canonical`): 18 joints relative to
the pelvis (m), then the pelvis' height over the template's leg length. Filtered, then
differentiated backwards over exactly three periods (Δt = 0.1 s, paper section "Motion mapping"),
live and offline by the same `FeatureExtractor.push`.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.human.calibration import Calibration, Calibrator
from studio.human.canonical import (
    ANKLES,
    FLIP_Y,
    bone_directions,
    heading_axes,
    rebuild,
)
from studio.human.filters import HoldThenEase, OneEuro
from studio.human.pose import HumanClip, HumanPose
from studio.human.skeleton import (
    ANKLE_HEIGHT,
    BONES,
    LEG_LENGTH,
    MIRROR_BONES,
    NEUTRAL_DIRECTION,
    NUM_BONES,
    NUM_JOINTS,
)
from studio.rhythm import PeriodicExtrapolator
from studio.timing import CONTROL_DT, CONTROL_HZ

Array = NDArray[np.float64]

DELTA_FRAMES = 3
"""Frames between the samples of a difference: 0.1 s at 30 Hz."""
FEATURE_DIM = 3 * NUM_BONES + 1
"""F: 18 joints × (x, y, z) and the height."""
FEATURE_NAMES: tuple[str, ...] = (*(f"{j}.{a}" for j in BONES for a in "xyz"), "height")
HEIGHT = FEATURE_DIM - 1
"""Index of the pelvis' height in q (in leg lengths; 1.09 upright, about 0.5 in a deep squat)."""

_DELTA_T = DELTA_FRAMES / CONTROL_HZ
# A bone tracked at under .4 or over 1.7 times its known length is a glitch: held like one unseen.
_GLITCH_SHORT, _GLITCH_LONG = 0.4, 1.7


@dataclass(frozen=True, kw_only=True)
class Features:
    """The triplet of one control period: q (F,) m (height: leg lengths), qd (F,) /s, qdd (F,) /s².

    unseen: s since the worst-seen of the hips and legs was seen, 0 when all are.
    """

    q: Array
    qd: Array
    qdd: Array
    unseen: float = 0.0

    @property
    def joints(self) -> Array:
        """(19, 3) m, the filtered person on the template's body, lower sole at z = 0."""
        return joints_of(self.q)


def joints_of(q: Array) -> Array:
    """Joints (..., 19, 3) m, pelvis at x = y = 0 and the lower sole at z = 0, of q (..., F)."""
    out = np.zeros(q.shape[:-1] + (NUM_JOINTS, 3))
    out[..., 1:, :] = q[..., :HEIGHT].reshape(q.shape[:-1] + (NUM_BONES, 3))
    out[..., 2] += q[..., HEIGHT, None] * LEG_LENGTH
    return out


def _points(direction: Array) -> Array:
    """(19, 3) of unit bone directions (18, 3): the joints of q, and as last z the height."""
    points = np.empty((NUM_JOINTS, 3))
    joints = rebuild(direction)
    points[:-1] = joints[1:]
    height = ANKLE_HEIGHT - min(joints[_L_ANKLE, 2], joints[_R_ANKLE, 2])
    points[-1] = (0.0, 0.0, height / LEG_LENGTH)
    return points


_L_ANKLE, _R_ANKLE = (int(a) for a in ANKLES)
_LEGS = np.array([BONES.index(f"{s}_{b}") for s in "lr" for b in ("hip", "knee", "ankle")])
_KEEP = np.array([*range(HEIGHT), 3 * NUM_JOINTS - 1])


class FeatureExtractor:
    """Remembers the filter, the last seven q and what is held; called by one thread.

    Every push is one control period of 1/30 s, fresh pose or not: None means that nobody was
    seen at all (held for half a second, then eased to neutral). Where a frame is late, push the
    last pose again.
    """

    def __init__(
        self,
        calibration: Calibration | None = None,
        mirror: bool = False,
        min_cutoff: float = 1.5,
        beta: float = 0.5,
    ) -> None:
        self.mirror = mirror
        self.calibrator = Calibrator(calibration, dt=CONTROL_DT)
        self._hold = HoldThenEase(NEUTRAL_DIRECTION, dt=CONTROL_DT)
        self._filter = OneEuro(min_cutoff, beta, dt=CONTROL_DT)
        self._extrapolator = PeriodicExtrapolator()
        self.reset()

    @property
    def calibration(self) -> Calibration:
        """The calibration as refined so far."""
        return self.calibrator.calibration

    def reset(self) -> None:
        """Forget the person's motion and go back to the calibration given."""
        self.calibrator.reset()
        self._hold.reset()
        self._filter.reset()
        self._extrapolator.forget()
        self._last: HumanPose | None = None
        self._q: list[Array] = []

    def push(self, pose: HumanPose | None) -> Features:
        """The triplet after one more control period."""
        again = pose is not None and pose is self._last
        if pose is None:
            direction = self._hold.push(NEUTRAL_DIRECTION, np.zeros(NUM_BONES, dtype=bool))
        else:
            direction = self._directions(pose)
        if self.mirror:
            direction = direction[MIRROR_BONES] * FLIP_Y
        points = _points(direction)
        # Legs that the last pose did not show move towards neutral: that is no march.
        again = again and not self._hold.age[_LEGS].any()
        guessed = self._extrapolator.guess() if again else None
        if guessed is not None:
            points = guessed
        else:
            self._extrapolator.see(points)
        return self._differences(self._filter.push(points).ravel()[_KEEP])

    def _directions(self, pose: HumanPose) -> Array:
        direction_w, length, seen = bone_directions(pose.joint_pos_w, pose.confidence)
        if pose is not self._last:
            self.calibrator.push(pose, length, seen)
            self._last = pose
        ratio = length / self.calibrator.bone_length
        seen = seen & (ratio > _GLITCH_SHORT) & (ratio < _GLITCH_LONG)
        return self._hold.push(direction_w @ heading_axes(self.calibrator.heading), seen)

    def _differences(self, q: Array) -> Features:
        if not self._q:
            self._q = [q] * (2 * DELTA_FRAMES)
        self._q.append(q)
        before, middle = self._q[-1 - 2 * DELTA_FRAMES], self._q[-1 - DELTA_FRAMES]
        del self._q[0]
        qd = (q - middle) / _DELTA_T
        qdd = (q - 2.0 * middle + before) / _DELTA_T**2
        return Features(q=q, qd=qd, qdd=qdd, unseen=float(self._hold.age[_LEGS].max()))


def clip_features(
    clip: HumanClip, calibration: Calibration | None = None, mirror: bool = False
) -> tuple[Array, Array, Array]:
    """q, q̇, q̈, each (T, F), of a clip of 30 frames a second, pushed one by one as live.

    Raises ValueError for a clip of another rate: `clip.at_rate(30)` makes one as a live loop
    would see it.
    """
    if len(clip) > 1 and abs(float(np.median(np.diff(clip.t))) * CONTROL_HZ - 1.0) > 0.05:
        raise ValueError(f"clip {clip.name!r} is not at 30 frames a second: use clip.at_rate(30)")
    extractor = FeatureExtractor(calibration, mirror)
    frames = [extractor.push(clip[i]) for i in range(len(clip))]
    return (
        np.array([f.q for f in frames]).reshape(-1, FEATURE_DIM),
        np.array([f.qd for f in frames]).reshape(-1, FEATURE_DIM),
        np.array([f.qdd for f in frames]).reshape(-1, FEATURE_DIM),
    )


_MIRROR_ORDER = np.append(
    np.arange(3 * NUM_BONES).reshape(NUM_BONES, 3)[MIRROR_BONES].ravel(), 3 * NUM_BONES
)
_MIRROR_FLIP = np.append(np.tile(FLIP_Y, NUM_BONES), 1.0)


def mirror_features(x: NDArray) -> NDArray:
    """Features, rates or triplets (..., k F) as the features of the mirrored person are."""
    q = x.reshape(*x.shape[:-1], -1, FEATURE_DIM)
    return (q[..., _MIRROR_ORDER] * _MIRROR_FLIP).astype(x.dtype).reshape(x.shape)
