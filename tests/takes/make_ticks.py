"""Ticks with plausible, seeded contents for the recording tests."""

from collections.abc import Iterator

import numpy as np

from studio import geometry
from studio.human.pose import HumanPose
from studio.robot import a1, kinematics
from studio.robot.pose import ReferencePose, RobotState
from studio.takes.tick import Tick


def make_ticks(count: int, *, seed: int = 0, human_every: int = 1) -> Iterator[Tick]:
    """`count` ticks of a swaying robot; a fresh human pose every `human_every` ticks."""
    rng = np.random.default_rng(seed)
    human = None
    for i in range(count):
        t = i * a1.CONTROL_DT
        joint_pos = a1.STAND_JOINT_POS + 0.1 * np.sin(t + np.arange(12))
        quat = geometry.quat_from_rpy(0.1 * np.sin(t + np.arange(3)))
        pos = np.array([0.3 * t, 0.0, a1.STAND_HEIGHT])
        fresh = i % human_every == 0
        if fresh:
            human = HumanPose(
                t=t + 5.0, joint_pos_w=rng.normal(size=(19, 3)), confidence=rng.random(19)
            )
        contact = np.array([1.0, 0.0, 0.0, 1.0])
        yield Tick(
            index=i,
            t=t,
            human=human,
            human_fresh=fresh,
            expert="walk" if i % 60 < 30 else "stand",
            votes={"stand": 0.5, "walk": 0.5, "sit": 0.0},
            state="walk" if i % 60 < 30 else "transition",
            transition_to=None if i % 60 < 30 else "stand",
            mode="live",
            controller="pd_playback",
            reference=ReferencePose(
                base_pos=pos, base_quat=quat, joint_pos=joint_pos, foot_contact=contact
            ),
            action=joint_pos + 0.01,
            target=joint_pos,
            robot=RobotState(
                base_pos=pos,
                base_quat=quat,
                joint_pos=joint_pos,
                foot_contact=contact,
                t=t + a1.CONTROL_DT,
                base_lin_vel_w=rng.normal(size=3),
                base_ang_vel_b=rng.normal(size=3),
                joint_vel=rng.normal(size=12),
                foot_pos_w=kinematics.foot_pos_w(pos, quat, joint_pos),
                torque=rng.normal(size=12),
            ),
            clipped=i % 7 == 0,
            fallen=False,
            timings_ms={"mapper": 0.1},
            counters={"frames": i},
        )
