"""The state machine stand | walk | sit | transition: which reference is tracked, by which expert.

In a state the retargeted reference passes through, eased into.
Between states a planned way (transition.plan) is tracked and the person is ignored; the selector
keeps voting and its latest decision counts when the way ends. A directive from safety may hold
the robot, send it to stand or to rest, and is never refused.
"""

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control import transition
from studio.control.drive_command import Directive
from studio.control.footing import between, facing, feet_w, solve, still, turn_z
from studio.control.stopping import Halt, PutDown, StrideMemory, in_the_air
from studio.control.transition import Path
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.intent import STATES, StateName
from studio.reference.motion import with_velocity
from studio.reference.stances import JOINT_SPEED, NEUTRAL, quickness
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

CROUCH_HEIGHT = 0.13
"""m, base height from which the robot stands up; the trunk is clear of the floor."""
EASE = 0.6
"""s in which the reference leaves a planned pose for the person's."""
_ROUNDING: dict[StateName, float] = {"stand": 0.01, "walk": 0.1, "sit": 0.01}
SPEED_LIMIT = {state: JOINT_SPEED[state] - np.radians(_ROUNDING[state]) for state in STATES}
"""rad/s, of the reference's joints: so little under JOINT_SPEED that rounding never crosses it."""


@dataclass(frozen=True, kw_only=True)
class Decision:
    """What the state machine decided for one period.

    state: "stand" | "walk" | "sit" | "transition". transition_to: where a transition leads, or
    where one will as soon as the feet are down. expert: the policy in charge. reference: what it
    tracks.
    """

    state: str
    transition_to: StateName | None
    expert: StateName
    reference: ReferencePose


class StateMachine:
    """One thread only. joint_speed: rad/s that a standing or sitting reference may reach.
    slope (2,): m that the floor rises a metre, in the reference's world."""

    def __init__(self) -> None:
        self.joint_speed, self.slope = JOINT_SPEED["stand"], transition.LEVEL
        self.reset("stand")

    def reset(self, state: StateName, base_xy: Array | None = None, yaw: float = 0.0) -> None:
        """Be in the neutral pose of `state` at base_xy (2,) m, heading yaw rad."""
        self.state: StateName = state
        neutral = NEUTRAL[state]
        xy = np.zeros(2) if base_xy is None else np.asarray(base_xy, dtype=np.float64)
        pose = replace(
            still(neutral),
            base_pos=np.array([xy[0], xy[1], neutral.base_pos[2]]),
            base_quat=geometry.quat_mul(turn_z(yaw), neutral.base_quat),
        )
        self._last = pose
        self.reference = with_velocity(pose, pose)
        self._path: Path | None = None
        self._path_t, self._changes_state = 0.0, False  # the latter: it leads to another state
        self._strides = StrideMemory()
        self._stopping: Halt | PutDown | None = None
        self._following = self._followed = False
        self._rested = True
        self._settling = 0

    @property
    def following(self) -> bool:
        """The reference is the person's. While it is not, theirs must go on from ours."""
        return self._following

    @property
    def busy(self) -> bool:
        """On a way of its own: the next step has no use for the person's reference."""
        return self._path is not None or self._stopping is not None or self._settling > 0

    @property
    def facing(self) -> float:
        """The way (rad) the feet face."""
        return facing(self._last, self.state)

    @property
    def in_transition(self) -> bool:
        """On the way from one state to another."""
        return self._path is not None and self._changes_state

    def crouch(self, base_xy: Array, yaw: float) -> None:
        """Be in a low crouch at base_xy (2,) m, heading yaw rad, about to stand up."""
        self.reset("stand", base_xy, yaw)
        neutral = self._last
        self._last = solve(
            neutral.base_pos * [1.0, 1.0, 0.0] + [0.0, 0.0, CROUCH_HEIGHT],
            neutral.base_quat,
            feet_w(neutral),
        )
        self.reference = with_velocity(self._last, self._last)
        self._begin("stand", "stand")

    def rejoin(self) -> None:
        """The reference to come has nothing to do with the last one: align and ease anew."""
        self._followed |= self._following
        self._following = False

    def step(
        self,
        wanted: StateName,
        reference: ReferencePose | None,
        directive: Directive = Directive.FOLLOW,
        ramp: float | None = None,
    ) -> Decision:
        """The reference to track in this control period.

        wanted: the state asked for. reference: the retargeted one of that state's expert, going
        on from ours (see `following`). None: there is none, the robot rests in that state. ramp: s
        in which to ease into following, if it begins now.
        """
        asked, wanted = wanted, self._wanted(wanted, directive)
        self._turn_back(directive)
        self._ramp = EASE if ramp is None else max(ramp, EASE)
        if self._path is None and self._stopping is None:
            self._leave(wanted, directive, follows=reference is not None and wanted == asked)
        self._followed = False
        pose = self._advance(reference)
        self.reference = with_velocity(pose, self._last)
        self._last = pose
        self._strides.see(pose if self.state == "walk" and self._following else None)
        return self._report(wanted)

    # Which way to go ---------------------------------------------------------------------------

    def _wanted(self, wanted: StateName, directive: Directive) -> StateName:
        kept = "stand" if directive is Directive.STAND or self.state == "walk" else self.state
        return wanted if directive is Directive.FOLLOW else kept

    def _turn_back(self, directive: Directive) -> None:
        """A call to stand also ends a transition to elsewhere, from wherever it is."""
        if directive is not Directive.STAND or not self.in_transition:
            return
        assert self._path is not None
        if self._path.goal == "stand":
            return
        seated = self._path.goal == "sit" and bool(in_the_air(self._last)[:2].any())
        self._begin("stand", "sit" if seated else "stand")
        self._changes_state = True

    def _leave(self, wanted: StateName, directive: Directive, follows: bool) -> None:
        """Decide what to do next while standing, walking or sitting in no planned motion."""
        if self._settling > 0:  # a state reached is shown before it is left again
            self._settling -= 1
            return
        follows = follows and directive in (Directive.FOLLOW, Directive.KEEP)
        if wanted == self.state and follows:
            if not self._following:
                self._following, self._rested = True, False
                self._ease_t, self._ease = 0.0, self._ramp
                self._held = self._last
            return
        moving, self._following = self._following or self._followed, False
        patient, last = directive is Directive.KEEP, self._last
        self._stopping = self._strides.halt(last, self.reference, patient) if moving else None
        if self._stopping is not None:
            return
        if self.state == "walk" and moving and in_the_air(self._last).any():
            self._stopping = PutDown.begin(self._last, self.reference)
        elif wanted != self.state:
            on_the_way = {self.state, wanted} == {"walk", "sit"}
            self._begin("stand" if on_the_way else wanted, self.state)
        elif not self._rested:
            self._begin(self.state, self.state)
            self._rested = True

    def _begin(self, goal: StateName, source: StateName) -> None:
        if goal == source:
            self._path = transition.settle(self._last, goal, self.slope)
        else:
            self._path = transition.plan(self._last, source, goal, self.slope)
        self._changes_state = goal != self.state
        self._path_t = 0.0
        self._stopping = None
        self._following = False

    # The pose of this period -------------------------------------------------------------------

    def _advance(self, reference: ReferencePose | None) -> RobotPose:
        if self._stopping is not None:
            pose = self._stopping.step()
            if self._stopping.done:
                self._stopping, self._rested = None, False
            return pose
        if self._path is not None:
            self._path_t += a1.CONTROL_DT
            pose = self._path.at(self._path_t)
            if self._path_t >= self._path.seconds - 1e-9:
                self._arrive()
            return pose
        if self._following and reference is not None:
            return self._follow(reference)
        return self._last

    def _arrive(self) -> None:
        assert self._path is not None
        if self._changes_state:
            self.state, self._settling = self._path.goal, 1
        self._path, self._rested, self._changes_state = None, True, False

    def _follow(self, reference: ReferencePose) -> RobotPose:
        """The person's reference, eased into."""
        target = still(reference)
        self._ease_t += a1.CONTROL_DT
        if self._ease_t >= self._ease:
            eased = target
        else:
            eased = between(self._held, target, minimum_jerk(self._ease_t / self._ease))
        limit = quickness(self.state, self.joint_speed) * SPEED_LIMIT[self.state]
        step = limit * a1.CONTROL_DT
        last = self._last.joint_pos
        joint_pos = np.minimum(np.maximum(eased.joint_pos, last - step), last + step)
        return RobotPose(
            base_pos=eased.base_pos,
            base_quat=eased.base_quat,
            joint_pos=joint_pos,
            foot_contact=eased.foot_contact,
        )

    def _report(self, wanted: StateName) -> Decision:
        if self._path is not None and self._changes_state:
            goal = self._path.goal
            return Decision(
                state="transition", transition_to=goal, expert=goal, reference=self.reference
            )
        return Decision(
            state=self.state,
            transition_to=wanted if wanted != self.state else None,
            expert=self.state,
            reference=self.reference,
        )
