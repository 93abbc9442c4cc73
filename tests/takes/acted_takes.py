"""Takes whose lag is known: library motion that was shown, and a synthetic person acting it out.

The shown motion begins and ends at rest (QUIET s each) in its state's neutral pose; the person
trails it by `person.delay_s`, to which a whole number of frames is added or taken away so that the
lag is spread evenly over 0 to 0.8 s.
"""

from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.reference.library import TASKS
from studio.reference.motion import ReferenceMotion
from studio.reference.realize import realize
from studio.reference.rest_padding import between_rests
from studio.robot import kinematics
from studio.robot.pose import RobotState
from studio.synthetic import Person, play
from studio.synthetic import signals as sig
from studio.takes.edit.edits import edit
from studio.takes.record.recorder import Recorder
from studio.takes.tick import Tick

Array = NDArray[np.float64]
DT = 1.0 / 30.0
QUIET = 1.5
"""s of rest at both ends."""
MOVING = tuple(name for name in TASKS if not name.endswith("quiet"))


@dataclass(frozen=True, kw_only=True)
class ActedTake:
    """lag: s the person is late by. human_pos (T, 19, 3) m, confidence (T, 19), motion of T."""

    task: str
    family: str
    sensor: str
    lag: float
    human_pos: Array
    confidence: Array
    motion: ReferenceMotion


def acted_take(
    task: str,
    rng: np.random.Generator,
    *,
    family: str = "default",
    sensor: str | None = None,
    seconds: float = 8.0,
    lag: float | None = None,
    idle_gestures: bool = True,
    difficulty: float | None = None,
    person: Person | None = None,
) -> ActedTake:
    """One take of a task by a new person; idle_gestures: they also do what nobody asked for."""
    hard = float(rng.uniform(0.3, 1.0)) if difficulty is None else difficulty
    track = between_rests(TASKS[task].sample(rng, seconds, hard), QUIET)
    person = person or Person.sample(rng, family, sensor=sensor)
    person = person if idle_gestures else person.still()
    wanted = float(rng.uniform(0.0, 0.8)) if lag is None else lag
    shift = round((wanted - person.delay_s) / DT)
    signal, room = sig.of_track(track), 40
    wide = np.concatenate(
        [np.repeat(signal[:1], room, axis=0), signal, np.repeat(signal[-1:], room, axis=0)]
    )
    acted = play(wide, person, rng, task).clip
    at = slice(room - shift, room - shift + len(track))
    return ActedTake(
        task=task,
        family=family,
        sensor=person.sensor.kind,
        lag=person.delay_s + shift * DT,
        human_pos=acted.joint_pos_w[at],
        confidence=acted.confidence[at],
        motion=realize(track),
    )


def record(
    acted: ActedTake,
    root: Path,
    name: str,
    *,
    keep: bool | None = None,
    session: str = "",
    style: str = "",
) -> None:
    """Write it as collecting does: the shown motion is the reference, the robot stands by."""
    recorder = Recorder(root)
    about = {
        "collect": {
            "task": acted.task,
            "state": acted.motion.state,
            "operator": "me",
            "session": session,
        }
    } | ({"style": style} if style else {})
    recorder.start(acted.task, name=name, about=about)
    poses = acted.motion.poses()
    for i, pose in enumerate(poses):
        t = i * DT
        human = HumanPose(t=t + 3.0, joint_pos_w=acted.human_pos[i], confidence=acted.confidence[i])
        robot = RobotState(
            base_pos=pose.base_pos,
            base_quat=pose.base_quat,
            joint_pos=pose.joint_pos,
            foot_contact=pose.foot_contact,
            t=t + DT,
            base_lin_vel_w=pose.base_lin_vel_w,
            base_ang_vel_b=pose.base_ang_vel_b,
            joint_vel=pose.joint_vel,
            foot_pos_w=kinematics.foot_pos_w(pose.base_pos, pose.base_quat, pose.joint_pos),
            torque=np.zeros(12),
        )
        tick = Tick(
            index=i,
            t=t,
            human=human,
            human_fresh=True,
            expert=acted.motion.state,
            votes={},
            state=acted.motion.state,
            transition_to=None,
            mode="collect",
            controller="pd_playback",
            reference=pose,
            action=pose.joint_pos,
            target=pose.joint_pos,
            robot=robot,
            clipped=False,
            fallen=False,
        )
        recorder.append(tick)
    recorder.close()
    if keep is not None:
        edit(root / name, keep=keep)
