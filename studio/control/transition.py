"""A way from any pose to another state's neutral pose: key poses joined by minimum-jerk segments.

Walking and standing differ by where the feet are, so diagonal pairs step into place. Sitting down
leans back and down on four planted feet until the rear calves lie on the floor, and only then
lifts the trunk and with it the front feet; the centre of mass is above the support all the way,
so that the way also holds slowly, and backwards. The person is ignored meanwhile.
"""

from dataclasses import dataclass, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.footing import feet_w, over_feet, placed, solve, turn_z
from studio.control.interpolation import (
    LegMode,
    Legs,
    PoseInterpolation,
    RearLegPivot,
    least_seconds,
    trapezoid,
)
from studio.geometry import scalars
from studio.geometry.time_scaling import minimum_jerk
from studio.reference.intent import StateName
from studio.reference.sitting import lean_uphill
from studio.reference.stances import NEUTRAL, NEUTRAL_FEET, fit_plane, rear_yaw
from studio.robot import a1, kinematics
from studio.robot.pose import RobotPose

Array = NDArray[np.float64]

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
FOOTHOLD_TOLERANCE = 0.015
"""m; feet nearer than this to their neutral place stay where they are."""
LEVEL = np.zeros(2)
DIAGONALS = ((1, 2), (0, 3))
"""FL with RR, FR with RL."""
_FOLDED = np.tile([0.0, LEAN_THIGH - LEAN_PITCH, -0.5 * np.pi - LEAN_THIGH], 4)
_LEAN = geometry.quat_from_rpy([0.0, LEAN_PITCH, 0.0])
_FOLDED_FEET = kinematics.foot_pos_w(np.zeros(3), _LEAN, _FOLDED)[2:]
"""(2, 3) m: the rear feet about the base when it leans back on its calves, heading along x."""


@dataclass(frozen=True, kw_only=True)
class Segment:
    """A way and the time that it takes.

    hurried: gets there by `trapezoid`, a third sooner at the same joint speed.
    """

    way: PoseInterpolation
    seconds: float
    hurried: bool = False

    def at(self, s: float) -> RobotPose:
        """The pose at a share s in [0, 1] of the segment's time."""
        u = trapezoid(s) if self.hurried else minimum_jerk(s)
        base_pos, base_quat, joint_pos = self.way.motion(np.array([u]))
        return RobotPose(
            base_pos=base_pos[0],
            base_quat=base_quat[0],
            joint_pos=joint_pos[0],
            foot_contact=self.way.end.foot_contact if s >= 1.0 else self.way.contact,
        )


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


def plan(start: RobotPose, source: StateName, goal: StateName, slope: Array = LEVEL) -> Path:
    """The way from `start`, a pose of state `source`, to the neutral pose of `goal`.

    slope (2,) m that the floor rises a metre, world: who sits down leans uphill.

    Walking and sitting are joined through standing: ask for "stand" first.
    """
    assert {source, goal} != {"walk", "sit"}, "walk and sit are joined through stand"
    feet = feet_w(start)
    if goal == "sit":
        stand = over_feet(feet, "stand")
        there = feet_w(stand)
        lean, sit = _sit_keys(there, slope)
        apart = np.linalg.norm(feet - there, axis=1).max() > FOOTHOLD_TOLERANCE
        keys = _onto_feet(start, feet, stand, there) if apart else []
        keys += [(lean, _all("plant"), 0.4), (sit, "rise", 0.5)]
    elif source == "sit":
        there = _standing_feet_from_sit(feet)
        lean, _ = _sit_keys(there, slope)
        over = over_feet(there, "stand")
        stand = solve(over.base_pos, over.base_quat, there)
        keys = [(lean, "sink", 0.5), (stand, _all("plant"), 0.4)]
    else:
        neutral = over_feet(feet, goal)
        keys = _onto_feet(start, feet, neutral, feet_w(neutral))
    return _path(goal, start, feet, keys, MIN_SECONDS)


def settle(start: RobotPose, state: StateName, slope: Array = LEVEL) -> Path:
    """The way from a pose of `state` to its neutral pose over the same feet; slope as in `plan`."""
    feet = feet_w(start)
    if state == "sit":
        sat = _sat_on(feet, rear_yaw(feet), slope)
        keys: list[Key] = [(sat, ("swing", "swing", "plant", "plant"), 0.4)]
    else:
        neutral = over_feet(feet, state)
        keys = _onto_feet(start, feet, neutral, feet_w(neutral))
    return _path(state, start, feet, keys, SETTLE_SECONDS)


Key = tuple[RobotPose, Legs | Literal["rise", "sink"], float]
"""A key pose, how it is reached from the one before, and the least time that takes, s."""


def _path(goal: StateName, start: RobotPose, feet: Array, keys: list[Key], at_least: float) -> Path:
    """start: of feet (4, 3). at_least: s that the whole takes."""
    ways: list[PoseInterpolation] = []
    for pose, legs, _ in keys:
        there = feet_w(pose)
        pair = (feet, there)
        if isinstance(legs, str):
            rising = legs == "rise"
            ways.append(
                RearLegPivot(start=start, end=pose, legs=_all("swing"), feet=pair, rising=rising)
            )
        else:
            ways.append(PoseInterpolation(start=start, end=pose, legs=legs, feet=pair))
        start, feet = pose, there
    least = np.array([[seconds] for _, _, seconds in keys])
    usual, quick = np.maximum(least_seconds(ways), least).T.tolist()
    hurried = sum(usual) > MAX_SECONDS
    seconds = quick if hurried else usual
    stretch = max(sum(seconds), at_least) / sum(seconds)  # never quicker: the speed limit is first
    return Path(
        goal=goal,
        segments=tuple(
            Segment(way=way, seconds=s * stretch, hurried=hurried)
            for way, s in zip(ways, seconds, strict=True)
        ),
    )


def _all(mode: LegMode) -> Legs:
    return (mode, mode, mode, mode)


def _onto_feet(start: RobotPose, now: Array, goal: RobotPose, there: Array) -> list[Key]:
    """Key poses that bring the base over `goal`'s and each foot from `now` to `there`, (4, 3) m,
    pair by pair."""
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
        base_quat = geometry.quat_slerp(start.base_quat, goal.base_quat, share)
        move = "swing" if high[group[0]] else "step"
        legs = tuple(move if leg in group else "plant" for leg in range(4))
        keys.append((solve(base_pos, base_quat, feet), legs, 0.4))  # type: ignore[arg-type]
    return keys


def _sit_keys(feet: Array, slope: Array) -> tuple[RobotPose, RobotPose]:
    """(lean, sit) for standing feet (4, 3): calves on the floor and front feet about to lift; sat.

    The rear feet stay where they stand; both poses face the way the feet do.
    """
    yaw = fit_plane(NEUTRAL_FEET["stand"][:, :2], feet[:, :2])[1]
    turn = scalars.yaw(yaw)
    quat = np.array(scalars.mul(turn, _LEAN.tolist()))
    base_pos = (feet[2:] - _FOLDED_FEET @ scalars.matrix(turn).T).mean(axis=0)
    return solve(base_pos, quat, feet), _sat_on(feet, yaw, slope)


def _sat_on(feet: Array, yaw: float, slope: Array) -> RobotPose:
    """Neutral sitting, heading yaw, with the middle of the rear feet where that of (4, 3) is."""
    sat = geometry.quat_rotate(turn_z(yaw), NEUTRAL_FEET["sit"][2:].mean(axis=0))
    level = placed(NEUTRAL["sit"], (feet[2:].mean(axis=0) - sat)[:2], yaw)
    pose = replace(level, joint_pos=lean_uphill(level.joint_pos, level.base_quat, slope))
    # Its hips move, its rear feet stay.
    stays = (feet_w(level) - feet_w(pose))[2:].mean(axis=0)
    return replace(pose, base_pos=level.base_pos + stays)


def _standing_feet_from_sit(feet: Array) -> Array:
    """(4, 3) where the feet stand after sitting: the rear ones stay, the front ones land ahead."""
    turned = NEUTRAL_FEET["stand"] @ scalars.matrix(scalars.yaw(rear_yaw(feet))).T
    rear = feet[2:].mean(axis=0)
    there = turned + (rear - turned[2:].mean(axis=0)) * np.array([1.0, 1.0, 0.0])
    there[2:, :2] = feet[2:, :2]
    return there
