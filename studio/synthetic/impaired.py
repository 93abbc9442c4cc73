"""A person as a worse sensor would send them: late, with frames lost and limbs mistaken."""

from collections import deque
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.pose import HumanPose
from studio.human.posture import body_heading
from studio.human.skeleton import INDEX
from studio.mocap.arrivals import Arrivals
from studio.mocap.source import Source
from studio.mocap.source_report import SourceReport
from studio.reference import gait
from studio.reference.intent import Intent
from studio.synthetic.operator import InteractiveOperator, OperatorSource
from studio.synthetic.sensor import Sensor, SensorState
from studio.synthetic.travelling import Travelling


@dataclass(frozen=True, kw_only=True)
class Impairment:
    """sensor: whose noise the synthetic person has (`performer.sensor`). delay: s, each frame's
    drawn anew. drop: share of frames lost, one by one. gaps: a second, how often frames are missing
    for `gap_s` s. glitches: a second, how often a skeleton's estimator takes one leg or arm for the
    other, or throws a limb aside, for 1 to 5 frames."""

    sensor: str = "mocap"
    delay: tuple[float, float] = (0.0, 0.0)
    drop: float = 0.0
    gaps: float = 0.0
    gap_s: tuple[float, float] = (0.1, 0.4)
    glitches: float = 0.0


IMPAIRMENTS: dict[str, Impairment] = {
    "mocap": Impairment(),
    "dropped": Impairment(sensor="kinect", drop=0.03, gaps=0.1),
    "kinect": Impairment(sensor="kinect", delay=(0.010, 0.060), drop=0.01, gaps=0.03, glitches=0.1),
    "webcam": Impairment(sensor="webcam", delay=(0.040, 0.120), drop=0.20, gaps=0.03, glitches=0.1),
}
BRISK = "brisk"
"""The source of somebody who walks straight on, at one speed drawn from the upper 40 % of what
there is."""
TRAVELLER = "travel"
"""The source of somebody who crosses the room, this way and that."""
_SIDES = tuple((INDEX[f"l_{j}"], INDEX[f"r_{j}"]) for j in ("elbow", "wrist"))
_LEGS = tuple((INDEX[f"l_{j}"], INDEX[f"r_{j}"]) for j in ("knee", "ankle", "toe"))
_THROW = 0.35
"""m by which a limb is thrown aside."""


class Impaired(Source):
    """Wraps a source; the same seed impairs it the same way. One thread only."""

    def __init__(
        self,
        source: Source,
        impairment: Impairment,
        seed: int = 0,
        sensor: "SensorBefore | None" = None,
    ) -> None:
        """sensor: through which the source is seen, too, whose poses have no noise of their own."""
        self.name, self.starts_live = source.name, source.starts_live
        self.duration, self.tours, self.take = source.duration, source.tours, source.take
        self._source, self._how = source, impairment
        self._rng, self._sensor = np.random.default_rng([seed, 7]), sensor
        self._underway: deque[tuple[float, HumanPose]] = deque()
        self._gap_until, self._glitch_left = -1.0, 0
        self._last_t = 0.0

    @property
    def label(self) -> str:
        """As the source's."""
        return self._source.label

    @property
    def report(self) -> SourceReport:
        """As the source's own: what it found, and what it refused."""
        return self._source.report

    @property
    def arrivals(self) -> Arrivals | None:
        """As the source's."""
        return self._source.arrivals

    def calibration_poses(self) -> list[HumanPose]:
        """As the source's, seen through the sensor: somebody calibrates in peace."""
        return [self._seen(pose) for pose in self._source.calibration_poses()]

    def close(self) -> None:
        """As the source's."""
        self._source.close()

    def push(self, raw: object) -> None:
        """As the source's: what is sent to it is impaired as it is read."""
        self._source.push(raw)

    def new_sender(self) -> None:
        """As the source's."""
        self._source.new_sender()

    def set_intent(self, intent: Intent) -> None:
        """As the source's."""
        self._source.set_intent(intent)

    def set_style(self, style: str) -> None:
        """As the source's."""
        self._source.set_style(style)

    def stand_in(self, *, seed: int, style: str) -> Source | None:
        """As the source's."""
        return self._source.stand_in(seed=seed, style=style)

    def show(self, intent: Intent) -> None:
        """As the source's."""
        self._source.show(intent)

    def read(self, t: float) -> HumanPose | None:
        """What has arrived by `t`; of several the newest."""
        pose = self._source.read(t)
        dt, self._last_t = t - self._last_t, t
        how, rng = self._how, self._rng
        draws = rng.random(4)
        if draws[0] < how.gaps * dt:
            self._gap_until = t + rng.uniform(*how.gap_s)
        if draws[1] < how.glitches * dt:
            self._glitch_left, self._kind = int(rng.integers(1, 6)), int(rng.integers(3))
        if pose is not None and draws[2] >= how.drop and t >= self._gap_until:
            if self._glitch_left > 0:
                pose, self._glitch_left = self._glitched(pose), self._glitch_left - 1
            self._underway.append((t + float(rng.uniform(*how.delay)), self._seen(pose)))
        arrived = None
        while self._underway and self._underway[0][0] <= t + 1e-9:
            arrived = self._underway.popleft()[1]
        return arrived

    def _seen(self, pose: HumanPose) -> HumanPose:
        return pose if self._sensor is None else self._sensor.see(pose)

    def _glitched(self, pose: HumanPose) -> HumanPose:
        joints = np.array(pose.joint_pos_w)
        if self._kind == 2:
            limb = [INDEX[f"r_{j}"] for j in ("elbow", "wrist")]
            joints[limb] += _THROW * self._rng.uniform(-1.0, 1.0, 3)
        else:
            for left, right in _SIDES if self._kind else _LEGS:
                joints[[left, right]] = joints[[right, left]]
        return replace(pose, joint_pos_w=joints)


class SensorBefore:
    """A sensor that stands before real people: its noise is along and across how they face at
    first."""

    def __init__(self, kind: str, seed: int) -> None:
        """kind: of `sensor.SENSORS`."""
        rng = np.random.default_rng([seed, 11])
        self._state = SensorState(Sensor.sample(rng, kind), rng)
        self._facing: NDArray[np.float64] | None = None

    def see(self, pose: HumanPose) -> HumanPose:
        """What it makes of the next pose; what was not seen before is not now."""
        if self._facing is None:
            heading, _ = body_heading(pose.joint_pos_w, pose.confidence)
            self._facing = geometry.quat_from_yaw(heading)
        ahead = geometry.quat_rotate_inverse(self._facing, pose.joint_pos_w)
        seen, confidence = self._state.see(ahead[None])
        return replace(
            pose,
            joint_pos_w=geometry.quat_rotate(self._facing, seen[0]),
            confidence=np.minimum(pose.confidence, confidence[0]),
        )


def real_sent_by(sensor: str, source: Source, seed: int) -> Impaired:
    """Real people (of `source`) as a sensor (of IMPAIRMENTS) would have sent them."""
    how = IMPAIRMENTS[sensor]
    return Impaired(source, how, seed, SensorBefore(how.sensor, seed))


def sent_by(sensor: str, source: str, seed: int, style: str = "march") -> Impaired:
    """A synthetic person as a sensor (of IMPAIRMENTS) sends them. source: `operator`,
    `operator:TASK`, BRISK or TRAVELLER."""
    impairment = IMPAIRMENTS[sensor]
    person: Source
    if source == TRAVELLER:
        person = Travelling(seed, sensor=impairment.sensor)
    elif source == BRISK:
        brisk = InteractiveOperator(seed=seed, style=style, sensor=impairment.sensor)
        speed = np.random.default_rng([seed, 5]).uniform(0.6, 1.0) * gait.MAX_SPEED
        brisk.set_intent(walking(float(speed), 0.0))
        person = brisk
    else:
        task = source.partition(":")[2] or None
        person = OperatorSource(task, seed=seed, style=style, sensor=impairment.sensor)
    return Impaired(person, impairment, seed)


def walking(speed: float, turn: float) -> Intent:
    """What somebody means who wants this speed (m/s) and turn (rad/s): the slowest pace that has
    it within its steps."""
    cadence = gait.slowest_cadence(speed, 0.8, turn)
    lift = max(float(gait.march_lift(cadence, speed)), 0.2)
    return Intent(
        state="walk", task="walking", speed=speed, turn=turn, cadence=cadence, lift=min(lift, 1.0)
    )
