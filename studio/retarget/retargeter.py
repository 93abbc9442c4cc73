"""HumanPose -> features -> selector -> expert -> contact -> temporal -> ReferencePose."""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio.human.calibration import Calibration
from studio.human.features import FeatureExtractor, Features
from studio.human.pose import HumanPose
from studio.options import Steps, Travel
from studio.reference.intent import StateName
from studio.retarget.easing import Easing
from studio.retarget.experts import EXPERTS
from studio.retarget.foothold_planner import FootholdPlanner
from studio.retarget.mapper import Expert, Mapped
from studio.retarget.pacing import PacedWalk
from studio.retarget.section_times import SectionTimes
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


@dataclass(frozen=True, kw_only=True)
class Retargeted:
    """One control period's retargeting.

    expert: the selector's decision, a state or "unknown"; active: the state acted on. votes: share
    per state; distance: to the nearest training frames, in units of their 99th percentile.
    reference: the kinematic A1. contact_prob: (4,) as the network says. clipped: the temporal
    clip acted. features: the triplet used, None before the first pose. mapped: what the expert
    said, None where it was not asked. timings_ms: per section.
    """

    expert: str
    active: str
    votes: dict[str, float]
    distance: float
    reference: ReferencePose
    contact_prob: Array
    clipped: bool
    features: Features | None
    mapped: Mapped | None = None
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
        travel: Travel = "auto",
        steps: Steps = "mapped",
    ) -> None:
        """travel: whether to walk through space beside a person (`retarget.travel`). steps: whose
        they are where a network says how to walk (`retarget.pacing`)."""
        self.experts = experts
        self.travel: Travel = travel
        self.steps: Steps = steps
        self.extractor = FeatureExtractor(calibration or Calibration(), mirror=mirror)
        self.path = PathReader()
        self._through_space = TravelWalk(self.path)
        self.selector = Selector(experts.prototypes, selector)
        self._filter = TripletFilter(SELECTOR_CUTOFF_HZ, a1.CONTROL_DT)
        self.planner = FootholdPlanner(settings)
        self.planner.stride_gain = experts.stride_gain
        self.reset()

    @staticmethod
    def load(
        style: str = "march",
        calibration: Calibration | None = None,
        *,
        mirror: bool = False,
        travel: Travel = "auto",
        steps: Steps = "mapped",
    ) -> "Retargeter":
        """A retargeter with the shipped experts of a style. StudioError if there are none."""
        experts = load_experts(style)
        return Retargeter(experts, calibration, mirror=mirror, travel=travel, steps=steps)

    def reset(self) -> None:
        """Forget the person and the motion; the robot stands at the origin. Keeps the lock."""
        self.extractor.reset()
        self.path.reset()
        self.selector.reset()
        self._filter.reset()
        self._features: Features | None = None
        self._choice: Choice | None = None
        self._first, self._easing = True, Easing()
        self.planner.start("stand")
        self._begin()

    @property
    def settings(self) -> RetargetSettings:
        """Tilt gain, dead zone and speed cap; may be replaced at any time."""
        return self.planner.settings

    @settings.setter
    def settings(self, settings: RetargetSettings) -> None:
        self.planner.settings = settings

    def set_expert(self, name: str | None) -> None:
        """Lock the state (None: automatic). StudioError for an unknown name."""
        self.selector.set_lock(name)

    def for_person(self, calibration: Calibration) -> "Retargeter":
        """One like this for another person, from the start: all but what was seen stays."""
        other = Retargeter(
            self.experts,
            calibration,
            mirror=self.extractor.mirror,
            selector=self.selector.config,
            settings=self.settings,
            travel=self.travel,
            steps=self.steps,
        )
        other.set_expert(self.selector.lock)
        return other

    def use(self, experts: Experts) -> None:
        """Other experts from the next frame on; person, place and lock stay."""
        lock, config = self.selector.lock, self.selector.config
        self.experts = experts
        self.planner.stride_gain = experts.stride_gain
        self.selector = Selector(experts.prototypes, config)
        self.selector.set_lock(lock)
        self._begin()

    def step(
        self, pose: HumanPose | None, dt: float = a1.CONTROL_DT, *, watch: bool = False
    ) -> Retargeted:
        """Retarget one control period; None reuses the last pose, then eases to neutral.

        watch: only see and select; the reference stays as it was, until `continue_from`.
        """
        times = SectionTimes()
        with times("features"):
            self._see(pose)
        if self._features is None:
            return self._idle(times)
        with times("selector"):
            triplet = np.concatenate([self._features.q, self._features.qd, self._features.qdd])
            if pose is not None or self._choice is None:
                self._choice = self.selector.step(self._filter.step(triplet))
            choice = self._choice
            # Whoever crosses the room walks, however their legs look to the selector.
            active = "walk" if self.travels and choice.active == "stand" else choice.active
            self._enter(self.selector.lock or active)  # type: ignore[arg-type]
        # Whoever locks a state wants it driven, however far the motion is from the training data.
        unknown = choice.expert == "unknown" and self.selector.lock is None and not self.travels
        self._easing.step(unknown, pose is not None, dt)
        reference, clipped = self.planner.last, False
        contact_prob = reference.foot_contact
        expert = self._expert_of(self.planner.state)
        with times("mapper"):
            said = mapped = None if watch and not expert.remembers else self._expert(triplet)
        with times("consistency"):
            if mapped is not None and not watch:
                contact_prob = mapped.contact_prob
                mapped = self._easing.toward_neutral(mapped, self.planner.state)
                reference, clipped = self.planner.step(mapped, dt)
        return Retargeted(
            expert=choice.expert,
            active=self.planner.state,
            votes=choice.votes,
            distance=choice.distance,
            reference=reference,
            contact_prob=contact_prob,
            clipped=clipped,
            features=self._features,
            mapped=said,
            timings_ms=times,
        )

    def _enter(self, state: StateName) -> None:
        """Make `state` the active one: the first time in its neutral pose, later by moving."""
        if state == self.planner.state and not self._first:
            return
        (self.planner.start if self._first else self.planner.enter)(state)
        self._first = False
        self._begin()

    def _begin(self) -> None:
        """The active state's expert starts on a new stretch of motion."""
        self._expert = self._expert_of(self.planner.state).begin()

    def _expert_of(self, state: StateName) -> Expert:
        if state == "walk" and self.travel == "auto" and self.path.found:
            return self._through_space
        expert = self.experts.mappers[state]
        paced = state == "walk" and self.steps == "generated" and not expert.remembers
        return PacedWalk(expert, self.experts.stride_gain) if paced else expert

    def _see(self, pose: HumanPose | None) -> None:
        """The person's features and path; who is found to travel is followed from a stand on."""
        extractor, known = self.extractor, self.path.found
        if pose is not None:
            extractor.calibrator.travels = self.travels
            self._features = extractor.push(pose)
        self.path.mirror = extractor.mirror
        self.path.see(pose, extractor.calibrator.leg_length)
        beside = self.path.found and not known and self.travel == "auto"
        if beside and self.planner.state == "walk":
            self._easing.restart()
            self._begin()

    @property
    def travels(self) -> bool:
        """The person crosses the room now, and the robot is to do so too."""
        return self.travel == "auto" and self.path.moving

    def continue_from(self, pose: RobotPose, yaw: float) -> None:
        """Go on from `pose`, where a transition or a hold has left the robot, feet and all.

        yaw: rad, the way its feet face there.
        """
        self._first = False
        self.planner.continue_from(pose, yaw)

    def _idle(self, times: SectionTimes) -> Retargeted:
        share = {name: 0.0 for name in EXPERTS}
        return Retargeted(
            expert="unknown",
            active=self.planner.state,
            votes=share,
            distance=float("inf"),
            reference=self.planner.last,
            contact_prob=self.planner.last.foot_contact,
            clipped=False,
            features=None,
            timings_ms=times,
        )
