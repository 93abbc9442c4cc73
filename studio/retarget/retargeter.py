"""HumanPose -> features -> selector -> expert -> contact -> temporal -> ReferencePose."""

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from studio import spatial
from studio.human.calibration import Calibration, Calibrator
from studio.human.features import FeatureExtractor, Features
from studio.human.pose import HumanPose
from studio.reference import scalars
from studio.reference.consistency import ContactLock, limit_speed, limit_turn
from studio.reference.stances import NEUTRAL
from studio.retarget.mapper import RATES, Mapped
from studio.retarget.selector import (
    SELECTOR_CUTOFF_HZ,
    Choice,
    Selector,
    SelectorConfig,
    TripletFilter,
)
from studio.retarget.settings import RetargetSettings, cap_stride, shape_tilt
from studio.retarget.states import EXPERTS
from studio.retarget.store import Experts, load_experts
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

HOLD = 0.3
"""s without a human pose before the reference eases to neutral."""
EASE = 0.6
"""s that easing to neutral (or back) takes."""


@dataclass(frozen=True, kw_only=True)
class Retargeted:
    """One control period's retargeting.

    expert: the selector's decision, a state or "unknown"; active: the state acted on. votes: share
    per state; distance: to the nearest training frames, in units of their 99th percentile.
    reference: the kinematic A1. contact_prob: (4,) as the network says. clipped: the temporal
    clip acted. features: the triplet used, None before the first pose. timings_ms: per section.
    """

    expert: str
    active: str
    votes: dict[str, float]
    distance: float
    reference: ReferencePose
    contact_prob: Array
    clipped: bool
    features: Features | None
    timings_ms: dict[str, float] = field(default_factory=dict)


class Retargeter:
    """The flow above, for one person; only the control loop's thread calls it."""

    def __init__(
        self,
        experts: Experts,
        calibration: Calibration | None = None,
        *,
        mirror: bool = False,
        selector: SelectorConfig | None = None,
        settings: RetargetSettings | None = None,
    ) -> None:
        self.experts = experts
        self.settings = settings or RetargetSettings()
        self.extractor = FeatureExtractor(calibration or Calibration(), mirror=mirror)
        self.selector = Selector(experts.prototypes, selector)
        self._filter = TripletFilter(SELECTOR_CUTOFF_HZ, a1.CONTROL_DT)
        self._lock = ContactLock()
        self.reset()

    @staticmethod
    def load(
        style: str = "march",
        calibration: Calibration | None = None,
        *,
        mirror: bool = False,
        models: Path | None = None,
    ) -> "Retargeter":
        """A retargeter with the shipped experts of a style. StudioError if there are none."""
        return Retargeter(load_experts(style, models), calibration, mirror=mirror)

    def reset(self) -> None:
        """Forget the person and the motion; the robot stands at the origin. Keeps the lock."""
        self.extractor.reset()
        self.selector.reset()
        self._filter.reset()
        self._features: Features | None = None
        self._choice: Choice | None = None
        self._start_in(NEUTRAL["stand"])
        self._active = "stand"

    def set_expert(self, name: str | None) -> None:
        """Lock the state (None: automatic). StudioError for an unknown name."""
        self.selector.set_lock(name)

    def set_calibration(self, calibration: Calibration) -> None:
        """Use a refined calibration from the next frame on, without a jump in the motion."""
        self.extractor.calibrator = Calibrator(calibration, dt=a1.CONTROL_DT)

    def step(self, pose: HumanPose | None, dt: float = a1.CONTROL_DT) -> Retargeted:
        """Retarget one control period; None reuses the last pose, then eases to neutral."""
        clock = perf_counter()
        timings: dict[str, float] = {}

        def lap(section: str) -> None:
            nonlocal clock
            now = perf_counter()
            timings[section] = 1e3 * (now - clock)
            clock = now

        self._silence = 0.0 if pose is not None else self._silence + dt
        if pose is not None:
            self._features = self.extractor.push(pose)
        lap("features")
        if self._features is None:
            return self._idle(timings)
        triplet = np.concatenate([self._features.q, self._features.qd, self._features.qdd])
        if pose is not None or self._choice is None:
            self._choice = self.selector.step(self._filter.step(triplet))
        choice = self._choice
        self._enter(choice.active if self.selector.lock is None else self.selector.lock)
        lap("selector")
        mapped = self.experts.mappers[self._active](triplet)
        lap("mapper")
        lost = choice.expert == "unknown" or self._silence > HOLD
        reference, clipped = self._consistent(self._toward_neutral(mapped, lost, dt), dt)
        lap("consistency")
        return Retargeted(
            expert=choice.expert,
            active=self._active,
            votes=choice.votes,
            distance=choice.distance,
            reference=reference,
            contact_prob=mapped.contact_prob,
            clipped=clipped,
            features=self._features,
            timings_ms=timings,
        )

    def _enter(self, state: str) -> None:
        """Make `state` the active one: the first time in its neutral pose, later by moving."""
        if self._first:
            self._start_in(NEUTRAL[state])
            self._first = False
        elif state != self._active and self._active != "sit":
            # A sitting trunk is near vertical: there the frame itself is the heading.
            self._yaw = float(spatial.heading(self._last.base_quat))
        self._active = state

    def _start_in(self, pose: RobotPose) -> None:
        self._first = True
        self._silence = 0.0
        self._ease = 1.0
        self._yaw = 0.0
        self._last = ReferencePose(
            base_pos=pose.base_pos,
            base_quat=pose.base_quat,
            joint_pos=pose.joint_pos,
            foot_contact=pose.foot_contact,
        )
        self._lock.reset(pose.base_pos)

    def continue_from(self, pose: RobotPose, yaw: float) -> None:
        """Go on from `pose`, where a transition or a hold has left the robot, feet and all.

        yaw: rad, the way its feet face there.
        """
        self._first = False
        self._yaw = yaw
        self._last = ReferencePose(
            base_pos=pose.base_pos,
            base_quat=pose.base_quat,
            joint_pos=pose.joint_pos,
            foot_contact=pose.foot_contact,
        )
        self._lock.reset(pose.base_pos)
        self._lock.step(pose.joint_pos, pose.base_quat, pose.foot_contact, a1.CONTROL_DT)

    def _toward_neutral(self, mapped: Mapped, lost: bool, dt: float) -> Mapped:
        """The mapped frame, blended to the state's neutral pose while the person is lost."""
        self._ease = float(np.clip(self._ease + (-dt if lost else dt) / EASE, 0.0, 1.0))
        s = self._ease * self._ease * (3.0 - 2.0 * self._ease)
        if s >= 1.0:
            return mapped
        rest = NEUTRAL[self._active]  # type: ignore[index]
        return Mapped(
            joint_pos=rest.joint_pos + s * (mapped.joint_pos - rest.joint_pos),
            base_quat=spatial.quat_slerp(rest.base_quat, mapped.base_quat, np.float64(s)),
            rates=s * mapped.rates,
            contact_prob=rest.foot_contact + s * (mapped.contact_prob - rest.foot_contact),
        )

    def _consistent(self, mapped: Mapped, dt: float) -> tuple[ReferencePose, bool]:
        """Contact, then temporal consistency; the root carried by the standing feet."""
        spec, rates = EXPERTS[self._active], mapped.rates  # type: ignore[index]
        neutral = NEUTRAL[self._active].base_quat  # type: ignore[index]
        quat_s = shape_tilt(mapped.base_quat, neutral, self.settings).tolist()
        joint_pos, contact = mapped.joint_pos, mapped.contact_prob
        vx, vy, _ = rates[RATES["base_lin_vel"]].tolist()
        if spec.turns:
            body = rates[RATES["base_ang_vel"]]
            self._yaw += float(scalars.matrix(quat_s)[2] @ body) * dt
            joint_pos = cap_stride(joint_pos, math.hypot(vx, vy), self.settings)
        c, s = math.cos(self._yaw), math.sin(self._yaw)
        drift = np.array([c * vx - s * vy, s * vx + c * vy, 0.0])
        wanted = np.array(scalars.mul(scalars.yaw(self._yaw), quat_s))
        last, lock = self._last, self._lock
        quat, turned = limit_turn(wanted, last.base_quat, spec.trunk_speed, dt)
        asked = lock.step(joint_pos, quat, contact, dt, drift, spec.root_speed)
        joint_pos, clipped = limit_speed(asked, last.joint_pos, spec.speed_limit, dt)
        if clipped:
            lock.recheck(joint_pos, quat)
        base_pos = lock.base_pos
        spun = scalars.rotvec(scalars.mul(scalars.conj(last.base_quat.tolist()), quat.tolist()))
        self._last = ReferencePose(
            base_pos=base_pos,
            base_quat=quat,
            joint_pos=joint_pos,
            foot_contact=np.where(lock.locked, np.maximum(contact, 0.5), np.minimum(contact, 0.5)),
            base_lin_vel_w=(base_pos - last.base_pos) / dt,
            base_ang_vel_b=np.array(spun) / dt,
            joint_vel=(joint_pos - last.joint_pos) / dt,
        )
        return self._last, clipped or turned

    @property
    def slips(self) -> int:
        """Locked feet that could not be held and were locked anew, since the start."""
        return self._lock.slips

    def _idle(self, timings: Mapping[str, float]) -> Retargeted:
        share = {name: 0.0 for name in EXPERTS}
        return Retargeted(
            expert="unknown",
            active=self._active,
            votes=share,
            distance=float("inf"),
            reference=self._last,
            contact_prob=self._last.foot_contact,
            clipped=False,
            features=None,
            timings_ms=dict(timings),
        )
