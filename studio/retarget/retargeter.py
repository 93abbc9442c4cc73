"""HumanPose -> features -> selector -> expert -> contact -> temporal -> ReferencePose."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from time import perf_counter

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.human.calibration import Calibration
from studio.human.features import FeatureExtractor, Features
from studio.human.pose import HumanPose
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.experts import EXPERTS
from studio.retarget.foothold_planner import FootholdPlanner
from studio.retarget.mapper import Expert, Mapped
from studio.retarget.selector import (
    SELECTOR_CUTOFF_HZ,
    Choice,
    Selector,
    SelectorConfig,
    TripletFilter,
)
from studio.retarget.settings import RetargetSettings
from studio.retarget.store import Experts, load_experts
from studio.retarget.travel import PathReader, TravelWalk
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
        travel: bool = True,
    ) -> None:
        """travel: walk through space beside a person who does (`retarget.travel`)."""
        self.experts, self.travel = experts, travel
        self.extractor = FeatureExtractor(calibration or Calibration(), mirror=mirror)
        self.path = PathReader()
        self._through_space = TravelWalk(self.path)
        self.selector = Selector(experts.prototypes, selector)
        self._filter = TripletFilter(SELECTOR_CUTOFF_HZ, a1.CONTROL_DT)
        self._planner = FootholdPlanner(settings)
        self._planner.stride_gain = experts.stride_gain
        self.reset()

    @staticmethod
    def load(
        style: str = "march",
        calibration: Calibration | None = None,
        *,
        mirror: bool = False,
        travel: bool = True,
        models: Path | None = None,
    ) -> "Retargeter":
        """A retargeter with the shipped experts of a style. StudioError if there are none."""
        experts = load_experts(style, models)
        return Retargeter(experts, calibration, mirror=mirror, travel=travel)

    def reset(self) -> None:
        """Forget the person and the motion; the robot stands at the origin. Keeps the lock."""
        self.extractor.reset()
        self.path.reset()
        self.selector.reset()
        self._filter.reset()
        self._features: Features | None = None
        self._choice: Choice | None = None
        self._first, self._silence, self._ease = True, 0.0, 1.0
        self._planner.start("stand")
        self._begin()

    @property
    def settings(self) -> RetargetSettings:
        """Tilt gain, dead zone and speed cap; may be replaced at any time."""
        return self._planner.settings

    @settings.setter
    def settings(self, settings: RetargetSettings) -> None:
        self._planner.settings = settings

    def set_expert(self, name: str | None) -> None:
        """Lock the state (None: automatic). StudioError for an unknown name."""
        self.selector.set_lock(name)

    def use(self, experts: Experts) -> None:
        """Other experts from the next frame on; person, place and lock stay."""
        lock, config = self.selector.lock, self.selector.config
        self.experts = experts
        self._planner.stride_gain = experts.stride_gain
        self.selector = Selector(experts.prototypes, config)
        self.selector.set_lock(lock)
        self._begin()

    def step(
        self, pose: HumanPose | None, dt: float = a1.CONTROL_DT, *, watch: bool = False
    ) -> Retargeted:
        """Retarget one control period; None reuses the last pose, then eases to neutral.

        watch: only see and select; the reference stays as it was, until `continue_from`.
        """
        clock = perf_counter()
        timings: dict[str, float] = {}

        def lap(section: str) -> None:
            nonlocal clock
            now = perf_counter()
            timings[section] = 1e3 * (now - clock)
            clock = now

        self._silence = 0.0 if pose is not None else self._silence + dt
        self._see(pose)
        lap("features")
        if self._features is None:
            return self._idle(timings)
        triplet = np.concatenate([self._features.q, self._features.qd, self._features.qdd])
        if pose is not None or self._choice is None:
            self._choice = self.selector.step(self._filter.step(triplet))
        choice = self._choice
        # Whoever crosses the room walks, however their legs look to the selector.
        active = "walk" if self.travels and choice.active == "stand" else choice.active
        self._enter(self.selector.lock or active)  # type: ignore[arg-type]
        lap("selector")
        # Whoever locks a state wants it driven, however far the motion is from the training data.
        unknown = choice.expert == "unknown" and self.selector.lock is None and not self.travels
        self._ease_on(unknown or self._silence > HOLD, dt)
        reference, clipped = self._planner.last, False
        contact_prob = reference.foot_contact
        expert = self._expert_of(self._planner.state)
        mapped = None if watch and not expert.remembers else self._expert(triplet)
        lap("mapper")
        if mapped is not None and not watch:
            contact_prob = mapped.contact_prob
            reference, clipped = self._planner.step(self._toward_neutral(mapped), dt)
        lap("consistency")
        return Retargeted(
            expert=choice.expert,
            active=self._planner.state,
            votes=choice.votes,
            distance=choice.distance,
            reference=reference,
            contact_prob=contact_prob,
            clipped=clipped,
            features=self._features,
            timings_ms=timings,
        )

    def _enter(self, state: StateName) -> None:
        """Make `state` the active one: the first time in its neutral pose, later by moving."""
        if self._first:
            self._planner.start(state)
            self._first = False
        elif state == self._planner.state:
            return
        else:
            self._planner.enter(state)
        self._begin()

    def _begin(self) -> None:
        """The active state's expert starts on a new stretch of motion."""
        self._expert = self._expert_of(self._planner.state).begin()

    def _expert_of(self, state: StateName) -> Expert:
        if state == "walk" and self.travel and self.path.found:
            return self._through_space
        return self.experts.mappers[state]

    def _see(self, pose: HumanPose | None) -> None:
        """The person's features and path; who is found to travel is followed from a stand on."""
        extractor, known = self.extractor, self.path.found
        if pose is not None:
            extractor.calibrator.travels = self.travels
            self._features = extractor.push(pose)
        self.path.mirror = extractor.mirror
        self.path.see(pose, extractor.calibrator.leg_length)
        if self.path.found and not known and self.travel and self._planner.state == "walk":
            self._ease = 0.0
            self._begin()

    @property
    def travels(self) -> bool:
        """The person crosses the room now, and the robot is to do so too."""
        return self.travel and self.path.moving

    def continue_from(self, pose: RobotPose, yaw: float) -> None:
        """Go on from `pose`, where a transition or a hold has left the robot, feet and all.

        yaw: rad, the way its feet face there.
        """
        self._first = False
        self._planner.continue_from(pose, yaw)

    def _ease_on(self, lost: bool, dt: float) -> None:
        """Towards neutral while the person is lost, and back."""
        self._ease = min(max(self._ease + (-dt if lost else dt) / EASE, 0.0), 1.0)

    def _toward_neutral(self, mapped: Mapped) -> Mapped:
        """The mapped frame, blended to the state's neutral pose by how far that has gone."""
        s = self._ease * self._ease * (3.0 - 2.0 * self._ease)
        if s >= 1.0:
            return mapped
        rest = NEUTRAL[self._planner.state]
        return Mapped(
            joint_pos=rest.joint_pos + s * (mapped.joint_pos - rest.joint_pos),
            base_quat=geometry.quat_slerp(rest.base_quat, mapped.base_quat, np.float64(s)),
            rates=s * mapped.rates,
            contact_prob=rest.foot_contact + s * (mapped.contact_prob - rest.foot_contact),
            turn=None if mapped.turn is None else s * mapped.turn,
        )

    @property
    def slips(self) -> int:
        """Locked feet that could not be held and were locked anew, since the start."""
        return self._planner.slips

    def _idle(self, timings: Mapping[str, float]) -> Retargeted:
        share = {name: 0.0 for name in EXPERTS}
        return Retargeted(
            expert="unknown",
            active=self._planner.state,
            votes=share,
            distance=float("inf"),
            reference=self._planner.last,
            contact_prob=self._planner.last.foot_contact,
            clipped=False,
            features=None,
            timings_ms=dict(timings),
        )
