"""Intents to reference poses: what the robot does when this is meant, live or a whole track.

Standing and sitting poses are pure functions of the intent; walking also remembers where the feet
stand (`walking.Walker`). `Realizer.step` and `realize` take the same path and agree.
"""

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.reference import sitting, stances, standing, walking
from studio.reference.contact import contact_label, contact_labels
from studio.reference.intent import Intent, IntentTrack
from studio.reference.motion import ReferenceMotion, with_velocity
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]


def realize(track: IntentTrack) -> ReferenceMotion:
    """The reference motion of a track: starts at x = y = 0, heading 0. Deterministic."""
    if track.state == "walk":
        base, quat, joints = _walk(walking.Walker(), [track[i] for i in range(len(track))])
    elif track.state == "sit":
        base, quat, joints = sitting.sit_poses(track.tilt, track.reach, track.reach_side)
    else:
        base, quat, joints = standing.stand_poses(
            track.tilt, track.crouch, track.reach, track.reach_side
        )
    feet = kinematics.foot_pos_w(base, quat, joints)
    return ReferenceMotion(
        state=track.state,
        task=track.task,
        dt=track.dt,
        base_pos=base,
        base_quat=quat,
        joint_pos=joints,
        foot_contact=contact_labels(feet, track.dt),
        params={
            "speed": float(np.mean(track.speed)),
            "turn": float(np.mean(track.turn)),
            "cadence": float(np.mean(track.cadence)),
        },
    )


class Realizer:
    """Realises intents one control period at a time. One thread at a time may use it."""

    def __init__(self, dt: float = a1.CONTROL_DT) -> None:
        self.dt = dt
        self._walker = walking.Walker()
        self.reset()

    def reset(self, x: float = 0.0, y: float = 0.0, yaw: float = 0.0) -> None:
        """Start again from (x, y) m with this heading."""
        self._place = (x, y, yaw)
        self._state: str | None = None
        self._last: ReferencePose | None = None
        self._feet: Array | None = None

    def step(self, intent: Intent) -> ReferencePose:
        """The pose of this instant; velocities and contacts by backward differences.

        A change of state starts anew in the new one, where the robot is: blending the two is the
        controller's transition.
        """
        if intent.state != self._state:
            self._change(intent)
        base, quat, joints = (v[0] for v in self._pose(intent))
        feet = kinematics.foot_pos_w(base, quat, joints)
        last, last_feet = self._last, self._feet
        moved = np.zeros(4) if last_feet is None else np.linalg.norm(feet - last_feet, axis=-1)
        contact = contact_label(feet[:, 2] - a1.FOOT_RADIUS, moved / self.dt)
        self._feet = feet
        now = RobotPose(base_pos=base, base_quat=quat, joint_pos=joints, foot_contact=contact)
        self._last = with_velocity(now, last or now, self.dt)
        return self._last

    def _change(self, intent: Intent) -> None:
        if self._last is not None and self._state is not None:
            yaw = self._place[2]
            if self._state == "walk":
                yaw = float(stances.tilt_of("walk", self._last.base_quat)[2])
            self._place = (float(self._last.base_pos[0]), float(self._last.base_pos[1]), yaw)
        self._state, self._last, self._feet = intent.state, None, None
        self._walker.reset(*self._place)

    def _pose(self, intent: Intent) -> tuple[Array, Array, Array]:
        if intent.state == "walk":
            return _walk(self._walker, [intent])
        tilt, reach = np.asarray(intent.tilt)[None], np.asarray(intent.reach)[None]
        side = np.asarray(intent.reach_side)[None]
        if intent.state == "sit":
            base, quat, joints = sitting.sit_poses(tilt, reach, side)
        else:
            crouch = np.array([intent.crouch])
            base, quat, joints = standing.stand_poses(tilt, crouch, reach, side)
        x, y, yaw = self._place
        turn = geometry.quat_from_yaw(yaw)
        base = geometry.quat_rotate(turn, base) + np.array([x, y, 0.0])
        return base, geometry.quat_mul(turn, quat), joints


def _walk(walker: walking.Walker, intents: list[Intent]) -> tuple[Array, Array, Array]:
    base, rpy, feet = (np.array(v) for v in zip(*(walker.step(intent) for intent in intents)))
    quat = geometry.quat_from_rpy(rpy)
    feet_b = geometry.quat_rotate_inverse(quat[:, None, :], feet - base[:, None, :])
    return base, quat, kinematics.leg_ik(feet_b)[0]
