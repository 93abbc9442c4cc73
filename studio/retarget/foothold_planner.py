"""What an expert says, frame by frame, becomes a planted motion: contact, then temporal."""

import math

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry import scalars
from studio.reference.consistency import limit_speed, limit_turn
from studio.reference.contact_lock import ContactConfig, ContactLock
from studio.reference.intent import StateName
from studio.reference.motion import with_velocity
from studio.reference.sitting import lean_uphill
from studio.reference.stances import NEUTRAL, quickness
from studio.retarget.experts import EXPERTS
from studio.retarget.mapper import RATES, Mapped
from studio.retarget.pacing import Turning
from studio.retarget.settings import RetargetSettings, cap_stride, on_slope, shape_tilt
from studio.retarget.support_margin import SupportMargin
from studio.robot import a1
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]

STEADY = 1.5
"""Times its expert's `root_speed` that the trunk is carried over its feet, however quick the joints
may be: at twice that (.4 m/s) it went on, and tipped over the other side of a raised paw."""
AS_PLANNED = ContactConfig()
"""For feet that are where they are planned to be."""


class FootholdPlanner:
    """Remembers feet, root, heading and the last pose; `start` forgets. One thread."""

    def __init__(self, settings: RetargetSettings | None = None) -> None:
        self.settings = settings or RetargetSettings()
        self.stride_gain = 1.0  # times the strides that a network says
        self.slope: Array = np.zeros(2)  # m that the floor rises a metre, in the reference's world
        self._lock, self._support = ContactLock(), SupportMargin()
        self.start("stand")

    def start(self, state: StateName) -> None:
        """At rest in the neutral pose of `state`, at the origin."""
        self.state: StateName = state
        self.continue_from(NEUTRAL[state], 0.0)

    def enter(self, state: StateName) -> None:
        """Another state from here on: the motion moves there, it does not jump."""
        if state == self.state:
            return
        if self.state != "sit":
            # A sitting trunk is near vertical: there the frame itself is the heading.
            self._yaw = float(geometry.heading(self.last.base_quat))
        self.state, self._turning = state, Turning()

    def continue_from(self, pose: RobotPose, yaw: float) -> None:
        """Go on from `pose`, feet and all; yaw: rad, the way its feet face."""
        self._yaw, self._turning = yaw, Turning()
        self.last = ReferencePose(
            base_pos=pose.base_pos,
            base_quat=pose.base_quat,
            joint_pos=pose.joint_pos,
            foot_contact=pose.foot_contact,
        )
        self._support.reset()
        self._lock.reset(pose.base_pos)
        self._lock.step(pose.joint_pos, pose.base_quat, pose.foot_contact, a1.CONTROL_DT)

    def step(self, mapped: Mapped, dt: float) -> tuple[ReferencePose, bool]:
        """The planted pose, its velocities, and whether the temporal clip cut anything short.

        The root is carried by the standing feet; only with none of them standing does it move by
        the expert's own estimate of its velocity.
        """
        spec, rates = EXPERTS[self.state], mapped.rates
        quat_s = shape_tilt(mapped.base_quat, NEUTRAL[self.state].base_quat, self.settings)
        joint_pos, contact = mapped.joint_pos, mapped.contact_prob
        vx, vy, _ = rates[RATES["base_lin_vel"]].tolist()
        felt = mapped.turn is None  # else a generator's steps, which need no mending
        if spec.turns:
            if mapped.turn is None:
                self._yaw += self._turning.step(quat_s, rates, dt) * dt
            else:
                self._yaw += mapped.turn * dt
            gain = self.stride_gain if felt else 1.0
            joint_pos = cap_stride(joint_pos, math.hypot(vx, vy), self.settings, gain)
        drift = np.array([*scalars.turn_xy(vx, vy, self._yaw), 0.0])
        wanted = np.array(scalars.mul(scalars.yaw(self._yaw), quat_s.tolist()))
        last, lock = self.last, self._lock
        lock.config = spec.consistency if felt else AS_PLANNED
        quick = quickness(self.state, on_slope(self.settings.joint_speed, self.slope))
        quat, turned = limit_turn(wanted, last.base_quat, quick * spec.trunk_speed, dt)
        if self.state == "stand":
            joint_pos = self._support.step(joint_pos, quat, contact, dt, self.slope)
        elif self.state == "sit":
            joint_pos = lean_uphill(joint_pos, quat, self.slope)
        root_speed = min(quick, STEADY) * spec.root_speed
        asked = lock.step(joint_pos, quat, contact, dt, drift, root_speed)
        joint_pos, clipped = limit_speed(asked, last.joint_pos, quick * spec.speed_limit, dt)
        if clipped:
            lock.recheck(joint_pos, quat)
        # The labels agree with what is done: a foot held through the hysteresis is a contact.
        labels = np.where(lock.locked, np.maximum(contact, 0.51), np.minimum(contact, 0.49))
        now = RobotPose(
            base_pos=lock.base_pos, base_quat=quat, joint_pos=joint_pos, foot_contact=labels
        )
        self.last = with_velocity(now, last, dt)
        return self.last, clipped or turned

    @property
    def slips(self) -> int:
        """Locked feet that could not be held and were locked anew, since the start."""
        return self._lock.slips
