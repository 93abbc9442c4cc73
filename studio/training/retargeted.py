"""Synthetic people walking, through the mapper → reference motions as a policy meets them live.

A library motion is what a mapper should have said; what it says is rougher: strides uneven, swings
quick, speed and joints not quite of one mind. A policy that has met only the former falls over the
latter. The robot stands still meanwhile: nothing it does comes back to the person.
"""

import numpy as np

from studio.imitation.bank import MotionBank, assemble, merged
from studio.mocap import open_source, poses
from studio.orders import PuppeteerConfig
from studio.puppeteer import Puppeteer
from studio.reference.motion import ReferenceMotion
from studio.robot import a1
from studio.robot.pose import ReferencePose

TASKS = ("walk", "turn")
STYLES = ("march", "circles")
SECONDS = 26.0
"""Of each person: the way into walking, and two motions of ten seconds."""
TASK = "retargeted"


def walking_bank(people: int, seed: int, frames: int = 301) -> MotionBank:
    """Motions of `people` people a task and style, their references cut to `frames` periods."""
    motions = []
    for style in STYLES:
        for task in TASKS:
            for k in range(people):
                for told in _references(task, style, 1000 * seed + k):
                    cuts = range(0, len(told) - frames + 1, frames)
                    motions += [_motion(told[i : i + frames]) for i in cuts]
    return assemble("walk", (TASK,), motions, [1.0] * len(motions))


def with_people(bank: MotionBank, people: int, seed: int) -> MotionBank:
    """A walking bank, and what mappers make of people on top, at full difficulty."""
    return merged([bank, walking_bank(people, seed, bank.frames)], "walk") if people else bank


def _references(task: str, style: str, seed: int) -> list[list[ReferencePose]]:
    """What the controller tracks while its walking expert is in charge, stretch by stretch."""
    puppeteer = Puppeteer(PuppeteerConfig(style=style, controller="stand_still", seed=seed))
    stretches: list[list[ReferencePose]] = [[]]
    ticks = round(SECONDS * a1.CONTROL_HZ)
    source = open_source(f"operator:{task}", seed=seed, style=style)
    for _, pose in zip(range(ticks), poses(source)):
        tick = puppeteer.step(pose)
        if tick.state == "walk" or (tick.state == "transition" and tick.transition_to == "walk"):
            stretches[-1].append(tick.reference)
        elif stretches[-1]:
            stretches.append([])
    return stretches


def _motion(told: list[ReferencePose]) -> ReferenceMotion:
    return ReferenceMotion(
        state="walk",
        task=TASK,
        dt=a1.CONTROL_DT,
        base_pos=np.stack([pose.base_pos for pose in told]),
        base_quat=np.stack([pose.base_quat for pose in told]),
        joint_pos=np.stack([pose.joint_pos for pose in told]),
        foot_contact=np.stack([pose.foot_contact for pose in told]),
        params={},
    )
