"""Synthetic people, through the mapper → reference motions as a policy meets them live.

A library motion is what a mapper should have said; what it says is rougher: strides uneven, swings
quick, speed and joints not quite of one mind. A policy that has met only the former falls over the
latter. And who holds the robot in a state may do anything meanwhile: a person who marches in front
of a robot that is locked to sit makes it twitch in time, which tipped one over that had not met it.
The robot stands still meanwhile: nothing it does comes back to the person.
"""

from dataclasses import dataclass
from pathlib import Path

from studio.control.drive_command import PuppeteerConfig
from studio.control.staleness import stale_command
from studio.files import fingerprint
from studio.human.calibration import calibrate
from studio.puppeteer import Puppeteer
from studio.reference.intent import StateName
from studio.reference.motion import ReferenceMotion
from studio.retarget.store import MODELS
from studio.rl.bank import MotionBank, assemble, merged
from studio.rl.bank_store import kept
from studio.robot import a1
from studio.robot.pose import ReferencePose
from studio.synthetic.impaired import BRISK, Impaired, sent_by


@dataclass(frozen=True, kw_only=True)
class Acted:
    """What people do while a state's expert is in charge, in each style; lock: of the state.

    sources: of `impaired.sent_by`. sensors: person by person another one sees them, in turns.
    """

    sources: tuple[str, ...]
    styles: tuple[str, ...]
    lock: str
    sensors: tuple[str, ...] = ("mocap",)


ACTED: dict[str, Acted] = {
    "walk": Acted(
        sources=("operator:walk", "operator:turn", BRISK),
        styles=("march", "circles"),
        lock="auto",
        sensors=("mocap", "dropped", "kinect"),
    ),
    "sit": Acted(
        sources=tuple(
            f"operator:{task}" for task in ("march", "walk", "tilt", "sit_tilt", "sit_manipulate")
        ),
        styles=("march",),
        lock="sit",
    ),
}
"""States whose policies meet people in training."""
SECONDS = 26.0
"""Of each person: the way into the state, and two motions of ten seconds."""
TASK = "retargeted"
CODE = (
    "geometry", "rhythm", "timing", "human", "robot", "reference", "scenes", "sim", "synthetic",
    "retarget", "control", "sources", "mocap", "puppeteer", "link/link", "link/sim", "rl/bank",
    "training/retargeted",
)  # fmt: skip
"""The code that decides what mappers make of people: none of the page's, of takes, of training."""


def acted_bank(state: StateName, people: int, seed: int, frames: int = 301) -> MotionBank:
    """Motions of `people` people a task and style, their references cut to `frames` periods."""
    motions = []
    acted = ACTED[state]
    for style in acted.styles:
        for source in acted.sources:
            for k in range(people):
                sensor = acted.sensors[k % len(acted.sensors)]
                person = sent_by(sensor, source, 1000 * seed + k, style)
                for poses in _references(state, person, style, 1000 * seed + k):
                    cuts = range(0, len(poses) - frames + 1, frames)
                    motions += [
                        ReferenceMotion.of(state, TASK, poses[i : i + frames]) for i in cuts
                    ]
    return assemble(state, (TASK,), motions, [1.0] * len(motions))


def with_people(bank: MotionBank, people: int, seed: int, cache: Path | None = None) -> MotionBank:
    """A state's bank, and what mappers make of people on top, at full difficulty.

    cache: folder to keep the latter in, a second for each; new code of CODE or a new
    mapper makes new ones.
    """
    if not people or bank.state not in ACTED:
        return bank
    drawn = bank.state, people, seed, bank.frames
    weights = sorted((MODELS / "mapper").rglob("*.safetensors"))
    key = [fingerprint(*CODE, *weights), *drawn]
    acted = kept(cache, f"people-{bank.state}", key, lambda: acted_bank(*drawn))
    return merged([bank, acted], bank.state)


def _references(
    state: StateName, person: Impaired, style: str, seed: int
) -> list[list[ReferencePose]]:
    """What the controller tracks while the state's expert is in charge, stretch by stretch."""
    lock = ACTED[state].lock
    puppeteer = Puppeteer(
        PuppeteerConfig(style=style, state=lock, controller="stand_still", seed=seed),
        calibrate(person.calibration_poses()),
    )
    stretches: list[list[ReferencePose]] = [[]]
    for k in range(round(SECONDS * a1.CONTROL_HZ)):
        tick = puppeteer.step(person.read(k * a1.CONTROL_DT), stale_command)
        if tick.state == state or (tick.state == "transition" and tick.transition_to == state):
            stretches[-1].append(tick.reference)
        elif stretches[-1]:
            stretches.append([])
    return stretches
