"""What a sensor makes of a person: jitter, bias, shrinkage and drop-outs of mocap or cameras."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio.errors import unknown_name
from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.synthetic.filters import BandLimitedNoise
from studio.synthetic.signals import DT

Array = NDArray[np.float64]
SENSORS: tuple[str, ...] = ("mocap", "kinect", "webcam")

_LIMBS: tuple[tuple[int, ...], ...] = tuple(
    tuple(INDEX[f"{side}_{joint}"] for joint in joints)
    for side in ("r", "l")
    for joints in (("elbow", "wrist"), ("wrist",), ("ankle", "toe"), ("toe",))
)
"""Groups of joints that a camera loses together."""


@dataclass(frozen=True, kw_only=True)
class Sensor:
    """Noise of one sensor, per axis (depth, sideways, up) in m; people face it, so depth is x.

    jitter: standard deviation from frame to frame. bias: of errors that wander over a second.
    scale: seen size over true size. drop_rate: times a second that a limb is lost, each for
    `drop_s` seconds on average. hip_centred: no global translation (webcam landmarks).
    """

    kind: str = "mocap"
    jitter: tuple[float, float, float] = (0.0, 0.0, 0.0)
    bias: tuple[float, float, float] = (0.0, 0.0, 0.0)
    scale: float = 1.0
    drop_rate: float = 0.0
    drop_s: float = 0.3
    hip_centred: bool = False

    @staticmethod
    def sample(rng: np.random.Generator, kind: str) -> "Sensor":
        """Webcam: depth 8-31 mm, others 4-25 mm, skeleton 5-11 % small (docs/findings.md).

        Raises StudioError for an unknown kind.
        """

        def mm(low: float, high: float) -> float:
            return float(rng.uniform(low, high)) * 1e-3

        if kind == "mocap":
            x = mm(0.1, 1.0)
            return Sensor(kind=kind, jitter=(x, x, x))
        if kind == "kinect":
            return Sensor(
                kind=kind,
                jitter=(mm(2, 8), mm(1, 5), mm(1, 5)),
                bias=(mm(3, 15), mm(2, 10), mm(2, 10)),
                scale=float(rng.uniform(0.95, 1.03)),
                drop_rate=float(rng.uniform(0.0, 0.06)),
            )
        if kind == "webcam":
            return Sensor(
                kind=kind,
                jitter=(mm(8, 31), mm(4, 25), mm(4, 25)),
                bias=(mm(10, 40), mm(5, 20), mm(5, 20)),
                scale=float(rng.uniform(0.89, 0.95)),
                drop_rate=float(rng.uniform(0.0, 0.12)),
                hip_centred=True,
            )
        raise unknown_name("sensor", kind, SENSORS)


class SensorState:
    """One sensor watching one person. One thread; `see` takes the next T frames."""

    def __init__(self, sensor: Sensor, rng: np.random.Generator) -> None:
        fast, slow, self._drops = rng.spawn(3)
        self.sensor = sensor
        # Trackers smooth a little themselves: half of the jitter is white, half wanders.
        self._white = fast
        self._wander = BandLimitedNoise(fast.spawn(1)[0], (NUM_JOINTS, 3), 0.05, DT)
        self._bias = BandLimitedNoise(slow, (NUM_JOINTS, 3), 0.5, DT)
        self._left = np.zeros(len(_LIMBS), dtype=int)  # frames each limb stays lost
        self._held = np.zeros((NUM_JOINTS, 3))

    def see(self, true_w: Array) -> tuple[Array, Array]:
        """True joints (T, 19, 3) to seen joints (T, 19, 3) and confidence (T, 19)."""
        s, steps = self.sensor, len(true_w)
        seen = s.scale * true_w
        if s.hip_centred:
            seen = seen - seen[:, :1]
        white = self._white.standard_normal((steps, NUM_JOINTS, 3))
        noise = np.asarray(s.jitter) * np.sqrt(0.5) * (white + self._wander(steps))
        seen = seen + noise + np.asarray(s.bias) * self._bias(steps)
        confidence = np.ones((steps, NUM_JOINTS))
        if s.drop_rate > 0.0:
            self._drop(seen, confidence)
        return seen, confidence

    def _drop(self, seen: Array, confidence: Array) -> None:
        """Lost limbs stay where they were last seen, with confidence 0."""
        chance = self.sensor.drop_rate * DT / len(_LIMBS)
        draws = self._drops.random((len(seen), 2, len(_LIMBS)))
        for i in range(len(seen)):
            starts = (draws[i, 0] < chance) & (self._left == 0)
            if starts.any():
                frames = 1 + (-np.log1p(-draws[i, 1]) * self.sensor.drop_s / DT).astype(int)
                self._left = np.where(starts, frames, self._left)
            if self._left.any():
                for k in np.flatnonzero(self._left):
                    confidence[i, list(_LIMBS[k])] = 0.0
                self._left = np.maximum(self._left - 1, 0)
                lost = confidence[i] == 0.0
                seen[i, lost] = self._held[lost]
            self._held = seen[i]
        self._held = self._held.copy()
