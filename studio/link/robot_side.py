"""The robot's side of a link: what its motors do in each of its steps, whatever arrives.

    limp       damped; rises when asked to, if the start-up check lets it
    rising     from wherever its legs are, over a crouch, to a stand
    standing   waits for an order near to standing
    following  does what it is told, within limits of its own
    holding    nothing came for 100 ms: the last target, or reference, is kept
    halting    references end: it comes to a stand in steps, and stands
    sitting    the line stays silent: down onto its belly, then limp until it is asked to rise

A stop, a tilt and what is not finite end each of them at once: limp, latched.
"""

from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.geometry.time_scaling import minimum_jerk
from studio.link.engine import CROUCH, MotorCommand
from studio.link.guards import Why, unfit_to_go_on, unfit_to_rise
from studio.link.link import Level
from studio.link.robot_policy import RobotPolicy
from studio.reference.intent import StateName
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotState

Array = NDArray[np.float64]
Phase = Literal["limp", "rising", "standing", "following", "holding", "halting", "sitting"]
PHASES: tuple[Phase, ...] = (
    "limp", "rising", "standing", "following", "holding", "halting", "sitting",
)  # fmt: skip

HOLD_AFTER = 0.1
"""s without an order: keep the last."""
HALT_AFTER = 0.3
"""s without a reference: come to a stand."""
SIT_AFTER: dict[Level, float] = {"targets": 0.5, "references": 10.0}
"""s without an order: sit down, then go limp. Who comes to a stand by himself may wait there."""
TO_CROUCH, TO_STAND, TO_BELLY, BLEND = 1.0, 1.5, 1.5, 0.3
"""s: legs folded under it; up from there; down again; and from a held target to a new order's."""
STILL_WITHIN = 2.0
"""s that a robot which is asked to rise waits for its legs to be still."""
NEAR = 0.35
"""rad between an order's joints and a stand's from which the robot begins to follow."""
MAX_KP, MAX_KD, LIMP_KD = 100.0, 5.0, 4.0
EPS = 1e-9


@dataclass(frozen=True, kw_only=True)
class Heard:
    """One order as it arrived, checked for shape and numbers.

    rise: how often whoever drives has asked it to stand up so far. stop: go limp. target (12,) rad,
    kp, kd: of level "targets". reference, state, in_transition: of level "references", as in
    `ControllerInput`.
    """

    level: Level
    rise: int = 0
    stop: bool = False
    target: Array
    kp: float = a1.KP
    kd: float = a1.KD
    reference: ReferencePose | None = None
    state: StateName = "stand"
    in_transition: bool = False


class RobotSide:
    """Remembers its phase and what it last heard. One thread; `now`: s on the robot's clock."""

    def __init__(self, dt: float, policy: RobotPolicy | None = None) -> None:
        """dt: s of its steps. policy: for references; without one they are not followed."""
        self.phase: Phase = "limp"
        self.why: Why = "switched on"
        self.target: Array = a1.STAND_JOINT_POS
        self._dt, self._policy = dt, policy
        self._every = max(round(a1.CONTROL_DT / dt), 1)
        self._heard: Heard | None = None
        self._heard_at = self._since = -np.inf
        self._rises = 0
        self._asked_at: float | None = None
        self._from: Array = self.target
        self._reach = np.zeros(12)
        self._count = 0

    def hear(self, order: Heard, now: float) -> None:
        """An order came that is no older than the last."""
        if order.stop:
            self.stop("asked to")
            self._rises = max(self._rises, order.rise)  # what was asked before it is void
        self._heard, self._heard_at = order, now

    def asks_to_rise(self, order: Heard) -> bool:
        """The order asks a limp robot to rise, for the first time."""
        return self.phase == "limp" and order.rise > self._rises and not order.stop

    def new_driver(self) -> None:
        """Somebody else drives from here on, who has asked for nothing yet."""
        self._rises = 0

    def set_down(self) -> None:
        """Somebody has stood it up: a simulated robot, at the beginning of an episode."""
        self.phase, self.why, self.target, self._heard = "standing", "", a1.STAND_JOINT_POS, None

    def stop(self, why: Why) -> None:
        """Limp until somebody asks it to rise."""
        if self.phase != "limp":
            self.phase, self.why = "limp", why

    def step(self, robot: RobotState, now: float) -> MotorCommand:
        """What the motors do in this step."""
        if self.phase != "limp" and (why := unfit_to_go_on(robot)):
            self.stop(why)
        self._move_on(robot, now)
        self._count += 1
        self._reach = np.minimum(self._reach + a1.SPEED_LIMIT * self._dt, _FULL_REACH)
        kp, kd = a1.KP, a1.KD
        if self.phase == "limp":
            seen = np.nan_to_num(robot.joint_pos)
            self.target = np.clip(seen, a1.JOINT_LOWER, a1.JOINT_UPPER)
            return MotorCommand(target=self.target, kp=0.0, kd=LIMP_KD)
        wanted = getattr(self, f"_{self.phase}")(robot, now)
        heard = self._heard
        if (
            heard is not None
            and heard.level == "targets"
            and self.phase in ("following", "holding")
        ):
            kp, kd = min(max(heard.kp, 0.0), MAX_KP), min(max(heard.kd, 0.0), MAX_KD)
        self._limit(wanted)
        return MotorCommand(target=self.target, kp=kp, kd=kd)

    # From phase to phase ------------------------------------------------------------------------

    def _move_on(self, robot: RobotState, now: float) -> None:
        heard, silent = self._heard, now - self._heard_at + EPS
        if heard is None:
            return
        if self.phase == "limp":
            if self.asks_to_rise(heard) and silent < HOLD_AFTER:
                self._rise(heard, robot, now)
        elif self.phase == "sitting":
            if now - self._since > TO_BELLY:
                self.stop("line silent")
        elif silent > SIT_AFTER[heard.level]:
            self._enter("sitting", now)
        elif self.phase == "rising":
            if now - self._since > TO_CROUCH + TO_STAND:
                self._enter("standing", now)
        elif self.phase == "halting":
            if self._policy is not None and self._policy.stands and self._may_follow(heard, silent):
                self._enter("following", now)
        elif self.phase == "standing":
            if self._may_follow(heard, silent):
                self._enter("following", now)
                if self._policy is not None and heard.level == "references":
                    self._policy.begin(robot, self.target)
        elif heard.level == "references" and silent > HALT_AFTER:
            self._enter("halting", now)
        elif self.phase == "following":
            if silent > HOLD_AFTER:
                self._enter("holding", now)
        elif silent < HOLD_AFTER:
            self._enter("following", now)

    def _rise(self, heard: Heard, robot: RobotState, now: float) -> None:
        self._asked_at = now if self._asked_at is None else self._asked_at
        self.why = unfit_to_rise(robot)
        if self.why == "moving" and now - self._asked_at < STILL_WITHIN:
            return  # it may still be sinking from where it was stopped
        self._rises, self._asked_at = heard.rise, None
        if not self.why:
            self._enter("rising", now, robot.joint_pos)

    def _may_follow(self, heard: Heard, silent: float) -> bool:
        """The order is fresh and near to standing: to follow it is no jump."""
        if silent > HOLD_AFTER:
            return False
        if heard.level == "targets":
            return bool(np.abs(heard.target - a1.STAND_JOINT_POS).max() < NEAR)
        if self._policy is None or heard.reference is None or heard.in_transition:
            return False
        away = np.abs(heard.reference.joint_pos - a1.STAND_JOINT_POS).max()
        return heard.state == "stand" and bool(away < NEAR)

    def _enter(self, phase: Phase, now: float, start: Array | None = None) -> None:
        self.phase, self._since, self.why = phase, now, ""
        if start is not None:
            self.target = np.clip(start, a1.JOINT_LOWER, a1.JOINT_UPPER)
        self._from = self.target

    # What each phase wants of the joints: (12,) rad -----------------------------------------------

    def _rising(self, robot: RobotState, now: float) -> Array:
        t = now - self._since
        if t < TO_CROUCH:
            return self._from + minimum_jerk(t / TO_CROUCH) * (CROUCH - self._from)
        s = min((t - TO_CROUCH) / TO_STAND, 1.0)
        return CROUCH + minimum_jerk(s) * (a1.STAND_JOINT_POS - CROUCH)

    def _standing(self, robot: RobotState, now: float) -> Array:
        return a1.STAND_JOINT_POS

    def _sitting(self, robot: RobotState, now: float) -> Array:
        s = min((now - self._since) / TO_BELLY, 1.0)
        return self._from + minimum_jerk(s) * (CROUCH - self._from)

    def _following(self, robot: RobotState, now: float) -> Array:
        heard = self._heard
        assert heard is not None
        if heard.level == "targets":
            share = min((now - self._since) / BLEND, 1.0)
            return self._from + minimum_jerk(share) * (heard.target - self._from)
        if self._policy is None or heard.reference is None or self._count % self._every:
            return self.target
        return self._policy.follow(heard.reference, heard.state, heard.in_transition, robot)

    def _holding(self, robot: RobotState, now: float) -> Array:
        heard = self._heard
        assert heard is not None
        return self.target if heard.level == "targets" else self._following(robot, now)

    def _halting(self, robot: RobotState, now: float) -> Array:
        if self._policy is None or self._count % self._every:
            return self.target
        return self._policy.come_to_stand(robot)

    def _limit(self, wanted: Array) -> None:
        """Within the joints' range, and no further in a period than they turn in one."""
        wanted = np.minimum(np.maximum(wanted, a1.JOINT_LOWER), a1.JOINT_UPPER)
        by = np.minimum(np.maximum(wanted - self.target, -self._reach), self._reach)
        self.target, self._reach = self.target + by, self._reach - np.abs(by)


_FULL_REACH = a1.SPEED_LIMIT * a1.CONTROL_DT
"""rad that a target may be moved at once: as far as its joint turns in a control period."""
