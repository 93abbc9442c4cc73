"""What nobody asks for: swaying, looking about, and idle arms (hips, folded, scratching …)."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.synthetic.filters import BandLimitedNoise, Fir, movement_kernel
from studio.synthetic.person import Person
from studio.synthetic.signals import DT

Array = NDArray[np.float64]


@dataclass(frozen=True, kw_only=True)
class Gesture:
    """An idle pose of the arms: (fwd, out, twist, flex) in degrees, and how it moves about it.

    arms: "both" or "one". wave: amplitudes in degrees, `hz` times a second; the second phase of a
    circle is on the outward angle, a quarter turn later. spread: degrees by which people differ.
    share: how often, beside the others.
    """

    arms: str
    pose: tuple[float, float, float, float]
    wave: tuple[float, float, float, float] = (0.0, 0.0, 0.0, 0.0)
    hz: float = 0.0
    spread: float = 10.0
    share: float = 1.0


GESTURES: dict[str, Gesture] = {
    "on_hips": Gesture(arms="both", pose=(-20, 45, 50, 95)),
    "folded": Gesture(arms="both", pose=(28, 8, 70, 105)),
    "clasped": Gesture(arms="both", pose=(15, 6, 40, 70)),
    "behind": Gesture(arms="both", pose=(-28, 10, 30, 35)),
    "pockets": Gesture(arms="both", pose=(-6, 18, 10, 40)),
    "sideways": Gesture(arms="both", pose=(5, 88, 0, 8), share=3.0),
    "elbows_out": Gesture(arms="both", pose=(20, 60, 30, 95), spread=14.0, share=2.5),
    "wings": Gesture(
        arms="both", pose=(10, 72, 0, 30), wave=(40, 8, 0, 15), hz=0.6, spread=14.0, share=2.5
    ),
    "overhead": Gesture(arms="both", pose=(75, 105, 0, 25), spread=14.0, share=2.0),
    "bar": Gesture(arms="both", pose=(-5, 42, -50, 108)),
    "circling": Gesture(arms="both", pose=(60, 60, 0, 15), wave=(60, 50, 0, 8), hz=0.8, share=2.5),
    "swinging": Gesture(arms="both", pose=(0, 12, 5, 15), wave=(40, 8, 0, 15), hz=0.8, share=2.5),
    "one_hip": Gesture(arms="one", pose=(-20, 45, 50, 95)),
    "scratching": Gesture(arms="one", pose=(75, 38, 10, 135), wave=(4, 4, 0, 10), hz=2.0),
    "watch": Gesture(arms="one", pose=(38, 10, 55, 95)),
    "phone": Gesture(arms="one", pose=(35, 15, 10, 145)),
    "waving": Gesture(arms="one", pose=(40, 80, -40, 80), wave=(0, 0, 25, 12), hz=1.5),
    "half_aside": Gesture(arms="one", pose=(10, 55, 0, 25)),
}
AT_REST = (
    "on_hips", "folded", "clasped", "behind", "pockets", "elbows_out", "bar", "swinging",
)  # fmt: skip
"""With both hands at the height of the trunk: nothing is reached for."""
_SETTLE_S = 0.8


class IdleGestures:
    """Gestures at random times: pose (T, 2, 4) and weight (T, 2), the same however time is cut."""

    def __init__(self, person: Person, rng: np.random.Generator) -> None:
        self._rng, self._gap = rng, person.habits.idle_gesture_gap_s
        self._names = person.habits.idle_gestures or tuple(GESTURES)
        shares = np.array([GESTURES[name].share for name in self._names])
        self._shares = shares / shares.sum()
        self._smooth = Fir(movement_kernel(_SETTLE_S, DT, person.habits.profile))
        self._frame = 0
        self._pose, self._wave = np.zeros((2, 4)), np.zeros((2, 4))
        self._hz, self._weight, self._origin = 0.0, np.zeros(2), 0
        self._start, self._stop = self._next(0), 0

    def _next(self, frame: int) -> int:
        if not np.isfinite(self._gap):
            return np.iinfo(np.int64).max
        wait = _SETTLE_S + 0.5 + self._rng.exponential(self._gap)
        return frame + round(wait / DT)

    def _begin(self) -> None:
        rng = self._rng
        gesture = GESTURES[self._names[rng.choice(len(self._names), p=self._shares)]]
        spread = rng.normal(0.0, gesture.spread, 4) * np.array([1.0, 0.6, 0.8, 1.0])
        uneven = rng.normal(0.0, 0.3 * gesture.spread, (2, 4))
        self._pose = np.radians(np.asarray(gesture.pose) + spread + uneven)
        self._pose[:, 3] = np.clip(self._pose[:, 3], 0.05, 2.5)
        self._wave = np.radians(np.asarray(gesture.wave))[None] * rng.uniform(0.6, 1.2)
        self._hz = gesture.hz * rng.uniform(0.7, 1.4)
        self._weight = np.ones(2) if gesture.arms == "both" else np.eye(2)[rng.integers(2)]
        self._origin = self._start
        long = rng.random() < 0.3  # kept through whatever else is done meanwhile
        self._stop = self._start + round(rng.uniform(*((8.0, 20.0) if long else (1.5, 6.0))) / DT)

    def __call__(self, steps: int) -> tuple[Array, Array]:
        """The next T frames: pose (T, 2, 4) rad and weight (T, 2) in [0, 1]."""
        pose, weight = np.empty((steps, 2, 4)), np.zeros((steps, 2))
        i = 0
        while i < steps:
            frame = self._frame + i
            if frame == self._start:
                self._begin()
            if frame >= self._start and frame == self._stop:
                self._start = self._next(frame)
            active = self._start <= frame < self._stop
            until = self._stop if active else self._start
            j = int(min(steps, i + until - frame))
            turn = 2.0 * np.pi * self._hz * DT * (np.arange(frame, frame + j - i) - self._origin)
            cycle = np.stack([np.sin(turn), np.cos(turn), np.sin(turn), np.sin(turn)], axis=-1)
            pose[i:j] = self._pose + self._wave * cycle[:, None]
            weight[i:j] = self._weight if active else 0.0
            i = j
        self._frame += steps
        return pose, self._smooth(weight)


class Sway:
    """Slow wander of a body that stands "still", and the quicker jiggling of a lively one."""

    # standard deviations: pelvis forward, left (m); trunk roll, pitch, yaw; head pitch, yaw;
    # knees (rad)
    SIZE = np.array([0.008, 0.006, 0.008, 0.012, 0.014, 0.05, 0.09, 0.015])
    LIVELY = np.array([0.012, 0.015, 0.035, 0.03, 0.07, 0.05, 0.08, 0.04])
    ARMS = np.array([0.04, 0.025, 0.06, 0.05])
    ARMS_LIVELY = np.array([0.12, 0.06, 0.10, 0.14])

    def __init__(self, person: Person, rng: np.random.Generator) -> None:
        body, arms, beat, quick = rng.spawn(4)
        trunk, limbs = quick.spawn(2)
        self._body = BandLimitedNoise(body, (len(self.SIZE),), 0.7, DT)
        self._arms = BandLimitedNoise(arms, (2, 4), 0.5, DT)
        self._beat = BandLimitedNoise(beat, (1,), 1.0, DT)
        self._quick = BandLimitedNoise(trunk, (len(self.SIZE),), 0.13, DT)
        self._quick_arms = BandLimitedNoise(limbs, (2, 4), 0.13, DT)
        self._size, self._lively = person.habits.sway, person.habits.lively

    def __call__(self, steps: int) -> tuple[Array, Array, Array]:
        """Body (T, 8) as in SIZE, arms (T, 2, 4) rad, the march's timing (T,) of unit spread."""
        body = self._size * self.SIZE * self._body(steps)
        body = body + self._lively * self.LIVELY * self._quick(steps)
        arms = self._size * self.ARMS * self._arms(steps)
        arms = arms + self._lively * self.ARMS_LIVELY * self._quick_arms(steps)
        return body, arms, self._beat(steps)[:, 0]
