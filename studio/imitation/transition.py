"""A way from any pose to another state's neutral pose: key poses joined by minimum-jerk segments.

Between two key poses every leg does one of three things: *plant* (its foot stays where it is on
the floor, the leg follows by IK while the base moves), *step* (its foot moves through the air to
a new place on the floor), or *swing* (its joints are interpolated, the foot carries nothing).
Walking and standing differ by where the feet are, so diagonal pairs step into place. Sitting down
leans back and down on four planted feet until the rear calves lie on the floor, and only then
lifts the trunk and with it the front feet; the centre of mass is above the support all the way,
so that the way also holds slowly, and backwards. The person is ignored meanwhile.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio import spatial
from studio.reference import scalars
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotPose

Array = NDArray[np.float64]
LegMode = Literal["plant", "step", "swing"]

MAX_JOINT_SPEED = np.radians(115.0)
"""rad/s, under the 120 deg/s of paper-notes so that rounding never crosses it."""
MIN_SECONDS, MAX_SECONDS = 1.0, 3.0
"""s; a way that would take longer is hurried. Only with a paw held high overhead is that not
enough: up to 3.6 s then, since the joints' speed limit comes first."""
SETTLE_SECONDS = 0.6
"""s, at least, to go back to neutral within a state."""
LEAN_PITCH = np.radians(-6.0)
"""Trunk pitch (nose up) when the rear calves have reached the floor and the front feet lift."""
LEAN_THIGH = -0.2
"""rad, rear thighs then, against the vertical: the hip behind the knee, so that the centre of mass
is over the calves before the front feet lift (at 0 the robot tips over its rear feet)."""
CLEARANCE = 0.04
FOOTHOLD_TOLERANCE = 0.015
"""m; feet nearer than this to their neutral place stay where they are."""
DIAGONALS = ((1, 2), (0, 3))
"""FL with RR, FR with RL."""


def minimum_jerk(s: float) -> float:
    """10 s^3 - 15 s^4 + 6 s^5 for s in [0, 1]: from 0 to 1 with rest at both ends."""
    s = min(max(s, 0.0), 1.0)
    return s * s * s * (10.0 + s * (6.0 * s - 15.0))


def trapezoid(s: float) -> float:
    """For s in [0, 1]: speeds up over the first fifth, slows down over the last.

    Its fastest is 1.25 times the mean, minimum jerk's 1.875.
    """
    s = min(max(s, 0.0), 1.0)
    if s > 0.5:
        return 1.0 - trapezoid(1.0 - s)
    return 3.125 * s * s if s < 0.2 else 1.25 * s - 0.125


@dataclass(frozen=True, kw_only=True)
class Segment:
    """From one key pose to the next; `legs`: what each leg does; `seconds`: how long it takes.

    hurried: gets there by `trapezoid`, a third sooner at the same joint speed.
    """

    start: RobotPose
    end: RobotPose
    legs: "Legs"
    seconds: float = 0.5
    hurried: bool = False

    def progress(self, s: float) -> float:
        """Share of the way at a share s in [0, 1] of the time."""
        return trapezoid(s) if self.hurried else minimum_jerk(s)

    def at(self, s: float) -> RobotPose:
        """The pose at a share s in [0, 1] of the segment's time."""
        base_pos, base_quat, joint_pos = self.motion(np.array([self.progress(s)]))
        return RobotPose(
            base_pos=base_pos[0],
            base_quat=base_quat[0],
            joint_pos=joint_pos[0],
            foot_contact=self.end.foot_contact if s >= 1.0 else self.contact,
        )

    @cached_property
    def feet(self) -> tuple[Array, Array]:
        """(4, 3) m each, world: the feet at the start and at the end."""
        return feet_w(self.start), feet_w(self.end)

    @property
    def contact(self) -> Array:
        """(4,) which feet carry on the way."""
        return np.array([mode == "plant" for mode in self.legs], dtype=np.float64)

    def motion(self, u: Array) -> tuple[Array, Array, Array]:
        """Base (N, 3), (N, 4) and joints (N, 12) at shares u (N,) of the way."""
        base_pos, base_quat, joint_pos = self._blend(u)
        by_foot = np.repeat([mode != "swing" for mode in self.legs], 3)
        if by_foot.any():
            c = u[:, None, None]
            start, end = self.feet
            foot = (1.0 - c) * start + c * end
            step = [mode == "step" for mode in self.legs]
            foot[..., 2] += CLEARANCE * np.outer(4.0 * u * (1.0 - u), step)
            foot_b = spatial.quat_rotate_inverse(base_quat[:, None], foot - base_pos[:, None])
            joint_pos = np.where(by_foot, kinematics.leg_ik(foot_b)[0], joint_pos)
        return base_pos, base_quat, joint_pos

    def _blend(self, u: Array) -> tuple[Array, Array, Array]:
        c, start, end = u[:, None], self.start, self.end
        quat = np.broadcast_to(start.base_quat, (len(u), 4))
        return (
            (1.0 - c) * start.base_pos + c * end.base_pos,
            spatial.quat_slerp(quat, np.broadcast_to(end.base_quat, (len(u), 4)), u),
            (1.0 - c) * start.joint_pos + c * end.joint_pos,
        )

    def at_speed(self, least: float) -> "Segment":
        """As long as its fastest joint needs at MAX_JOINT_SPEED, and at least `least` s."""
        u = np.array([self.progress(s) for s in np.linspace(0.0, 1.0, 25)])
        joints = self.motion(u)[2]
        fastest = float(np.max(np.abs(np.diff(joints, axis=0)))) * (len(joints) - 1)
        return replace(self, seconds=max(least, fastest / MAX_JOINT_SPEED))


@dataclass(frozen=True, kw_only=True)
class Haunches(Segment):
    """Between leaning and sitting: the trunk turns on the rear legs, whose calves lie on the floor.

    The thighs stay leaned back until the trunk is nearly up (cubic in its turn): else the centre
    of mass passes in front of the rear feet. `legs` is ignored.
    """

    rising: bool

    @property
    def contact(self) -> Array:
        """The rear feet carry."""
        return np.array([0.0, 0.0, 1.0, 1.0])

    def motion(self, u: Array) -> tuple[Array, Array, Array]:
        """Base (N, 3), (N, 4) and joints (N, 12) at shares u (N,) of the way."""
        _, quat, joint_pos = self._blend(u)
        low, high = (self.start, self.end) if self.rising else (self.end, self.start)
        w = u if self.rising else 1.0 - u
        # pitch + thigh + calf stays -90 degrees: what the thigh lags, the calf takes up
        lag = (_thigh(high) - _thigh(low)) * (w - w**3)
        joint_pos[:, [7, 10]] -= lag[:, None]
        joint_pos[:, [8, 11]] += lag[:, None]
        feet = spatial.quat_rotate(quat[:, None], kinematics.foot_pos_b(joint_pos))
        start, end = (feet[2:].mean(axis=0) for feet in self.feet)
        c = u[:, None]
        return (1.0 - c) * start + c * end - feet[:, 2:].mean(axis=1), quat, joint_pos


def _thigh(pose: RobotPose) -> float:
    """Angle of the rear thighs against the vertical, rad; > 0: the knee behind the hip."""
    nose = spatial.quat_rotate(pose.base_quat, [1.0, 0.0, 0.0])
    return float(np.mean(pose.joint_pos[[7, 10]]) - np.arcsin(np.clip(nose[2], -1.0, 1.0)))


@dataclass(frozen=True, kw_only=True)
class Path:
    """Segments one after another; ends in the neutral pose of `goal`."""

    goal: StateName
    segments: tuple[Segment, ...]

    @property
    def seconds(self) -> float:
        """How long it takes."""
        return sum(segment.seconds for segment in self.segments)

    def at(self, t: float) -> RobotPose:
        """The pose t seconds after the start; the last one from the end on."""
        for segment in self.segments:
            if t < segment.seconds - 1e-9:  # a rounding error before its end, a segment is over
                return segment.at(max(t, 0.0) / segment.seconds)
            t -= segment.seconds
        return self.segments[-1].at(1.0)


def plan(start: RobotPose, source: StateName, goal: StateName) -> Path:
    """The way from `start`, a pose of state `source`, to the neutral pose of `goal`.

    Walking and sitting are joined through standing: ask for "stand" first.
    """
    assert {source, goal} != {"walk", "sit"}, "walk and sit are joined through stand"
    if goal == "sit":
        stand = standing_over(start)
        lean, sit = _sit_keys(feet_w(stand))
        keys = _onto_feet(start, stand) if _apart(start, stand) else []
        keys += [(lean, _all("plant"), 0.4), (sit, "rise", 0.5)]
    elif source == "sit":
        feet = _standing_feet_from_sit(start)
        lean, _ = _sit_keys(feet)
        stand = _pose_on(feet, "stand")
        keys = [(lean, "sink", 0.5), (stand, _all("plant"), 0.4)]
    else:
        keys = _onto_feet(start, standing_over(start, goal))
    return _path(goal, start, keys)


def settle(start: RobotPose, state: StateName) -> Path:
    """The way from any pose of `state` to its neutral pose, where the feet are."""
    if state != "sit":
        return _path(state, start, _onto_feet(start, standing_over(start, state)), SETTLE_SECONDS)
    yaw = _rear_yaw(start)
    turn = spatial.quat_from_rpy([0.0, 0.0, yaw])
    rear = spatial.quat_rotate(turn, feet_w(NEUTRAL["sit"])[2:]).mean(axis=0)
    sat = placed(NEUTRAL["sit"], (feet_w(start)[2:].mean(axis=0) - rear)[:2], yaw)
    return _path("sit", start, [(sat, ("swing", "swing", "plant", "plant"), 0.4)], SETTLE_SECONDS)


def facing(pose: RobotPose, state: StateName) -> float:
    """The way (rad) the feet of a pose face, whatever the trunk on them does."""
    if state == "sit":
        return _rear_yaw(pose)
    legs = np.flatnonzero(pose.foot_contact > 0.5)
    legs = legs if len(legs) > 2 else np.arange(4)
    return fit_plane(feet_w(NEUTRAL[state])[legs, :2], feet_w(pose)[legs, :2])[1]


def _rear_yaw(pose: RobotPose) -> float:
    """Heading by the line of the rear feet: a sitting trunk is too steep to tell."""
    across = feet_w(pose)[3] - feet_w(pose)[2]
    return float(np.arctan2(-across[0], across[1]))


Legs = tuple[LegMode, LegMode, LegMode, LegMode]
Key = tuple[RobotPose, Legs | Literal["rise", "sink"], float]
"""A key pose, how it is reached from the one before, and the least time that takes, s."""


def _apart(a: RobotPose, b: RobotPose) -> bool:
    return bool(np.linalg.norm(feet_w(a) - feet_w(b), axis=1).max() > FOOTHOLD_TOLERANCE)


def _path(
    goal: StateName, start: RobotPose, keys: list[Key], least_seconds: float = MIN_SECONDS
) -> Path:
    ways: list[tuple[Segment, float]] = []
    for pose, legs, least in keys:
        if isinstance(legs, str):
            way = Haunches(start=start, end=pose, legs=_all("swing"), rising=legs == "rise")
        else:
            way = Segment(start=start, end=pose, legs=legs)
        ways.append((way, least))
        start = pose
    segments = _timed(ways, hurried=False)
    if sum(segment.seconds for segment in segments) > MAX_SECONDS:
        segments = _timed(ways, hurried=True)
    total = sum(segment.seconds for segment in segments)
    stretch = max(total, least_seconds) / total  # never quicker: the speed limit comes first
    return Path(
        goal=goal,
        segments=tuple(replace(s, seconds=s.seconds * stretch) for s in segments),
    )


def _timed(ways: list[tuple[Segment, float]], *, hurried: bool) -> list[Segment]:
    return [replace(way, hurried=hurried).at_speed(least) for way, least in ways]


def _all(mode: LegMode) -> Legs:
    return (mode, mode, mode, mode)


def feet_w(pose: RobotPose) -> Array:
    """(4, 3) m, foot centres of a pose in its own world."""
    return kinematics.foot_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos)


def standing_over(start: RobotPose, goal: StateName = "stand") -> RobotPose:
    """The neutral pose of `goal` at the place and heading that its feet fit best now."""
    neutral = NEUTRAL[goal]
    template = feet_w(neutral)
    position, yaw = fit_plane(template[:, :2], feet_w(start)[:, :2])
    return placed(neutral, position, yaw)


def fit_plane(a: Array, b: Array) -> tuple[Array, float]:
    """The translation (2,) and turn that carry points a (N, 2) onto b best: b = R a + p."""
    ca, cb = a.mean(axis=0), b.mean(axis=0)
    da, db = a - ca, b - cb
    yaw = float(np.arctan2(np.sum(da[:, 0] * db[:, 1] - da[:, 1] * db[:, 0]), np.sum(da * db)))
    c, s = np.cos(yaw), np.sin(yaw)
    return cb - np.array([[c, -s], [s, c]]) @ ca, yaw


def placed(pose: RobotPose, position: Array, yaw: float) -> RobotPose:
    """The pose turned by yaw about the world's z axis, then moved by position (2,)."""
    turn = spatial.quat_from_rpy([0.0, 0.0, yaw])
    base = spatial.quat_rotate(turn, pose.base_pos) + np.array([*position, 0.0])
    return replace(pose, base_pos=base, base_quat=spatial.quat_mul(turn, pose.base_quat))


def _onto_feet(start: RobotPose, goal: RobotPose) -> list[Key]:
    """Key poses that bring the base over `goal`'s and each foot to its place, pair by pair."""
    now, there = feet_w(start), feet_w(goal)
    away = np.linalg.norm(now - there, axis=1) > FOOTHOLD_TOLERANCE
    high = now[:, 2] > a1.FOOT_RADIUS + FOOTHOLD_TOLERANCE
    if not away.any():
        return [(goal, _all("plant"), 0.5)]
    keys: list[Key] = []
    # A paw held up is put down before anything else moves, joint by joint: on a straight way of the
    # foot the leg would pass its shoulder, where joints turn without end.
    groups = [[leg for leg in range(4) if high[leg]]]
    groups += [[leg for leg in pair if away[leg] and not high[leg]] for pair in DIAGONALS]
    groups = [group for group in groups if group]
    feet = now.copy()
    for i, group in enumerate(groups):
        feet = feet.copy()
        feet[group] = there[group]
        share = (i + 1) / len(groups)
        base_pos = (1.0 - share) * start.base_pos + share * goal.base_pos
        base_quat = spatial.quat_slerp(start.base_quat, goal.base_quat, share)
        move = "swing" if high[group[0]] else "step"
        legs = tuple(move if leg in group else "plant" for leg in range(4))
        keys.append((solve(base_pos, base_quat, feet), legs, 0.4))  # type: ignore[arg-type]
    return keys


def solve(base_pos: Array, base_quat: Array, feet: Array) -> RobotPose:
    """The pose with the base where it is asked to be and the feet at (4, 3) m, world."""
    joint_pos, _ = kinematics.leg_ik(spatial.quat_rotate_inverse(base_quat, feet - base_pos))
    return RobotPose(
        base_pos=base_pos, base_quat=base_quat, joint_pos=joint_pos, foot_contact=np.ones(4)
    )


def _pose_on(feet: Array, state: StateName) -> RobotPose:
    """Neutral `state` over feet (4, 3) m on the floor."""
    position, yaw = fit_plane(feet_w(NEUTRAL[state])[:, :2], feet[:, :2])
    over = placed(NEUTRAL[state], position, yaw)
    return solve(over.base_pos, over.base_quat, feet)


def _sit_keys(feet: Array) -> tuple[RobotPose, RobotPose]:
    """(lean, sit) for standing feet (4, 3): calves on the floor and front feet about to lift; sat.

    The rear feet stay where they stand; both poses face the way the feet do.
    """
    yaw = fit_plane(feet_w(NEUTRAL["stand"])[:, :2], feet[:, :2])[1]
    turn = spatial.quat_from_rpy([0.0, 0.0, yaw])
    sit = NEUTRAL["sit"]
    offset = feet[2:].mean(axis=0) - spatial.quat_rotate(turn, feet_w(sit)[2:].mean(axis=0))
    sat = placed(sit, offset[:2], yaw)
    quat = spatial.quat_mul(turn, spatial.quat_from_rpy([0.0, LEAN_PITCH, 0.0]))
    rear = np.array([0.0, LEAN_THIGH - LEAN_PITCH, -0.5 * np.pi - LEAN_THIGH])
    folded = kinematics.foot_pos_b(np.tile(rear, 4))[2:]
    base_pos = (feet[2:] - spatial.quat_rotate(quat, folded)).mean(axis=0)
    return solve(base_pos, quat, feet), sat


def _standing_feet_from_sit(start: RobotPose) -> Array:
    """(4, 3) where the feet stand after sitting: the rear ones stay, the front ones land ahead."""
    template = feet_w(NEUTRAL["stand"])
    rear = feet_w(start)[2:]
    turn = spatial.quat_from_rpy([0.0, 0.0, _rear_yaw(start)])
    turned = spatial.quat_rotate(turn, template)
    feet = turned + (rear.mean(axis=0) - turned[2:].mean(axis=0)) * np.array([1.0, 1.0, 0.0])
    feet[2:, :2] = rear[:, :2]
    return feet


def with_velocity(pose: RobotPose, previous: RobotPose, dt: float = a1.CONTROL_DT) -> ReferencePose:
    """The pose as a reference, its velocities by backward differences from `previous`."""
    turned = scalars.mul(scalars.conj(previous.base_quat.tolist()), pose.base_quat.tolist())
    return ReferencePose(
        base_pos=pose.base_pos,
        base_quat=pose.base_quat,
        joint_pos=pose.joint_pos,
        foot_contact=pose.foot_contact,
        base_lin_vel_w=(pose.base_pos - previous.base_pos) / dt,
        base_ang_vel_b=np.array(scalars.rotvec(turned)) / dt,
        joint_vel=(pose.joint_pos - previous.joint_pos) / dt,
    )
