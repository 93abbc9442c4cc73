"""Movements to respond to: the track that a person acts out, and its signal at every stage.

A signal is one number a control period that grows with the movement, the same one for a person and
for a robot: how high a hand or a paw is, how far a trunk is tilted. Only its course over time
counts, not its unit.
"""

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.geometry.time_scaling import smoothstep
from studio.human.features import HEIGHT, Features
from studio.human.pose import HumanPose
from studio.human.skeleton import INDEX, LEG_LENGTH, NUM_JOINTS
from studio.reference.intent import IntentTrack, StateName
from studio.reference.marching import Bout, march_track
from studio.reference.tracks import frames_in, make_track
from studio.retarget.mapper import Mapped
from studio.robot import kinematics
from studio.takes.tick import Tick
from studio.timing import CONTROL_HZ

Array = NDArray[np.float64]

STAGES = ("person", "features", "mapper", "reference", "robot")
REST_S, RISE_S, HOLD_S, TIMES = 2.5, 0.4, 1.0, 3
"""Seconds of standing, of the movement there and of that back, of staying there; how often."""
STEPS = Bout(half_strides=10, cadence=1.4, lift=0.8, pause=REST_S)


@dataclass(frozen=True, kw_only=True)
class Gesture:
    """task: of the library. size: of `intent` at its largest: a field of Intent, in its unit."""

    task: str
    intent: str = ""
    size: tuple[float, ...] = field(default=(1.0,))
    state: StateName = "stand"


GESTURES = {
    "raised hand": Gesture(task="manipulate_right", intent="reach", size=(1.0, 0.0)),
    "lean": Gesture(task="tilt", intent="tilt", size=(0.35, 0.0, 0.0)),
    "bend": Gesture(task="tilt", intent="tilt", size=(0.0, 0.4, 0.0)),
    "twist": Gesture(task="tilt", intent="tilt", size=(0.0, 0.0, 0.4)),
    "squat": Gesture(task="tilt", intent="crouch", size=(0.8,)),
    "first step": Gesture(task="march", state="walk"),
}
"""To the right, forward, to the left, the right hand; a first step is the first of a few."""
STEPPING = [name for name, gesture in GESTURES.items() if gesture.state == "walk"]
"""One stride is like the next, so that only their beginning tells how late they are."""


def track_of(name: str) -> tuple[IntentTrack, Array]:
    """What is acted out: the movement TIMES times after REST_S each; and (TIMES,) s at which each
    begins."""
    gesture = GESTURES[name]
    once = REST_S + 2.0 * RISE_S + HOLD_S
    if name in STEPPING:
        track = march_track(gesture.task, TIMES * 7.0, [STEPS] * TIMES, lead=REST_S)
        moves = np.diff(np.concatenate([[0.0], track.cadence > 0.0]).astype(float))
        return track, np.flatnonzero(moves > 0.0)[:TIMES].astype(np.float64) * track.dt
    length = frames_in(TIMES * once + REST_S)
    begins = REST_S + once * np.arange(TIMES, dtype=np.float64)
    t = np.arange(length)[:, None] / CONTROL_HZ
    up, down = (t - begins) / RISE_S, (begins + 2.0 * RISE_S + HOLD_S - t) / RISE_S
    shape = smoothstep(np.minimum(up, down)).sum(axis=1)
    values = shape[:, None] * gesture.size
    values = values[:, 0] if len(gesture.size) == 1 else values
    return make_track(gesture.state, gesture.task, length, **{gesture.intent: values}), begins


def signals(name: str, pose: HumanPose, seen: Features, said: Mapped, tick: Tick) -> list[float]:
    """The movement's signal at each of STAGES in one control period."""
    bones = seen.q[:HEIGHT].reshape(-1, 3)
    body = np.vstack([np.zeros(3), bones])
    body[:, 2] += LEG_LENGTH * seen.q[HEIGHT]
    ref, robot = tick.reference, tick.robot
    # A paw that is raised on the way to a stride is no step: those of the walking state count.
    counts = tick.state == "walk" or name not in STEPPING
    return [
        of_person(name, pose.joint_pos_w),
        of_person(name, body),
        of_robot(name, said.joint_pos, said.base_quat) * counts,
        of_robot(name, ref.joint_pos, ref.base_quat) * counts,
        of_robot(name, robot.joint_pos, robot.base_quat) * counts,
    ]


def of_person(name: str, joint_pos: Array) -> float:
    """Of joints (NUM_JOINTS, 3) m, z up, whichever way the person faces."""
    at = dict(zip(INDEX, joint_pos.reshape(NUM_JOINTS, 3)))
    left = at["l_hip"] - at["r_hip"]
    hips = np.arctan2(left[1], left[0])
    trunk = at["neck"] - at["pelvis"]
    sideways, back = geometry.turn_xy(trunk[:2], -hips)
    match name:
        case "raised hand" | "right hand":
            return float(at["r_wrist"][2] - at["r_shoulder"][2])
        case "left hand":
            return float(at["l_wrist"][2] - at["l_shoulder"][2])
        case "lean":
            return float(np.arctan2(-sideways, trunk[2]))
        case "bend":
            return float(np.arctan2(-back, trunk[2]))
        case "twist":
            across = at["l_shoulder"] - at["r_shoulder"]
            return float(geometry.wrap_angle(np.arctan2(across[1], across[0]) - hips))
        case "squat":
            return -float(at["pelvis"][2])
    return float(abs(at["l_ankle"][2] - at["r_ankle"][2]))  # a step


def of_robot(name: str, joint_pos: Array, base_quat: Array) -> float:
    """Of joints (12,) rad and the trunk's attitude (4,) wxyz."""
    feet = geometry.quat_rotate(base_quat, kinematics.foot_pos_b(joint_pos))[:, 2]
    roll, pitch, yaw = geometry.quat_to_rpy(base_quat)
    of = {
        "raised hand": feet[0] - feet[2:].mean(),
        "right hand": feet[0] - feet[2:].mean(),
        "left hand": feet[1] - feet[2:].mean(),
        "lean": roll,
        "bend": pitch,
        "twist": yaw,
        "squat": feet.mean(),
        "first step": np.ptp(feet),
    }
    return float(of[name])
