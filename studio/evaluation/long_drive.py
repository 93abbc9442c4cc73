"""One person drives the robot for minutes → its falls, and how fast it walked.

After a fall the robot is stood up where it lies, as an operator would, and goes on.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.control.controllers import (
    Controller,
    ControllerInput,
    PolicyController,
    open_controller,
)
from studio.control.drive_command import PuppeteerConfig
from studio.control.policy import Policy
from studio.control.staleness import stale_command
from studio.evaluation.behind import met
from studio.mocap.source import Source
from studio.options import PAPER_JOINT_SPEED_DEG, ControllerName, Steps
from studio.puppeteer import Puppeteer
from studio.reference.intent import STATES, StateName
from studio.retarget.settings import joint_speed
from studio.retarget.store import Experts
from studio.rl.noise import NoiseConfig
from studio.robot.a1 import CONTROL_DT
from studio.sim import randomize
from studio.synthetic.impaired import sent_by
from studio.takes.tick import Tick

Array = NDArray[np.float64]
DynamicsName = Literal["nominal", "table_i"]
LIE_S = 3.0
"""s that a fallen robot lies before it is stood up."""
WINDOW = 60
"""Control periods (2 s) over which the speed asked for and the way made are compared."""
MOVING = 0.05
"""m/s asked for from which a window counts as walking."""

HOLDS: dict[str, dict[str, float]] = {
    "shipped": {},
    "nothing": {"heading_gain": 0.0},
    "heading, within a stride": {"heading_gain": 1.0, "heading_smooth": 0.0},
}
"""What the walking policy makes up for: its gains in 1/s, see `ObservationConfig`."""


@dataclass(frozen=True, kw_only=True)
class Case:
    """One row. source: a spec of the operator, or BRISK. sensor: a name of IMPAIRMENTS. dynamics:
    those of the robot the policies were made for, or draws of Table I and its cheap sensors
    (`rl.noise`). holds: a name of HOLDS. max_joint_speed: degrees/s that standing and sitting
    references' joints may reach. steps: whose, of walks (`retarget.pacing`). people, seconds: who
    drives it, each for how long."""

    source: str = "operator:walk"
    controller: ControllerName = "policy"
    dynamics: DynamicsName = "nominal"
    sensor: str = "mocap"
    holds: str = "shipped"
    max_joint_speed: float = PAPER_JOINT_SPEED_DEG
    steps: Steps = "mapped"
    people: int = 20
    seconds: float = 300.0


@dataclass(frozen=True, kw_only=True)
class Run:
    """One person's minutes. falls: s. asked, made: m/s, of each window of walking."""

    seconds: float
    falls: tuple[float, ...]
    asked: tuple[float, ...]
    made: tuple[float, ...]


def endure(case: Case, seed: int, experts: Experts | None = None) -> Run:
    """One person, drawn from `seed`, drives for `case.seconds`; experts: None for the shipped."""
    source = sent_by(case.sensor, case.source, seed)
    config = PuppeteerConfig(
        controller=case.controller,
        seed=seed,
        steps=case.steps,
        joint_speed=joint_speed(case.max_joint_speed),
    )
    puppeteer = met(source, config)
    if experts is not None:
        puppeteer.set_experts(experts)
    puppeteer.controller = _controller(case, seed)
    if case.dynamics == "table_i":
        links = int(np.count_nonzero(puppeteer.stage.world.model.body_mass > 0.0))
        drawn = randomize.draw(np.random.default_rng(seed), 1, links)
        puppeteer.stage.world.set_dynamics(drawn)
    puppeteer.reset()
    falls: list[float] = []
    rows: list[tuple[bool, float, Array]] = []
    for t, tick in set_up_again(puppeteer, source, case.seconds):
        if tick.fallen:
            falls.append(t)
        speed = float(np.hypot(*tick.reference.base_lin_vel_w[:2]))
        rows.append((tick.state == "walk" and not tick.fallen, speed, tick.robot.base_pos[:2]))
    asked, made = _windows(rows)
    return Run(seconds=case.seconds, falls=tuple(falls), asked=asked, made=made)


def set_up_again(
    puppeteer: Puppeteer, source: Source, seconds: float
) -> Iterator[tuple[float, Tick]]:
    """(s, tick) of each period of a drive for so long; a robot that fell lies for LIE_S, without
    ticks, and stands up."""
    lying = 0.0
    for k in range(round(seconds / CONTROL_DT)):
        human = source.read(k * CONTROL_DT)
        if lying > 0.0:
            lying -= CONTROL_DT
            if lying <= 0.0:
                puppeteer.stand_up()
                puppeteer.rejoin()
            continue
        tick = puppeteer.step(human, stale_command)
        if tick.fallen:
            lying = LIE_S
        yield k * CONTROL_DT, tick


def _controller(case: Case, seed: int) -> Controller:
    gains: dict[str, Any] = HOLDS[case.holds]
    controller = open_controller(case.controller)
    if gains:
        policies: dict[StateName, Policy] = {state: Policy.load(state) for state in STATES}
        walk = policies["walk"]
        policies["walk"] = walk.observing(replace(walk.observation, **gains))
        controller = PolicyController(policies)
    return (
        controller if case.dynamics == "nominal" else NoisySensors(controller, NoiseConfig(), seed)
    )


def _windows(rows: list[tuple[bool, float, Array]]) -> tuple[tuple[float, ...], tuple[float, ...]]:
    """Mean speed asked for, and way made along it per second, in windows spent walking."""
    asked, made = [], []
    for first in range(0, len(rows) - WINDOW, WINDOW):
        window = rows[first : first + WINDOW + 1]
        wanted = float(np.mean([speed for _, speed, _ in window]))
        if all(walks for walks, _, _ in window) and wanted > MOVING:
            way = np.diff([place for *_, place in window], axis=0)
            # Half a second at a time: a curve is no shortcut, wobble within a stride no way.
            steps = [np.linalg.norm(way[i : i + 15].sum(axis=0)) for i in range(0, WINDOW, 15)]
            asked.append(wanted)
            made.append(float(np.sum(steps)) / (WINDOW * CONTROL_DT))
    return tuple(asked), tuple(made)


class NoisySensors(Controller):
    """Wraps a controller: it sees the robot through sensors as cheap as those of the training.

    joint_pos: encoders with a bias of their own and noise; base_quat: a bias of the IMU in roll and
    pitch; base_ang_vel_b: a noisy gyro. One thread only.
    """

    def __init__(self, controller: Controller, noise: NoiseConfig, seed: int = 0) -> None:
        self.name = controller.name
        self._controller, self._noise = controller, noise
        self._rng = np.random.default_rng([seed, 11])
        self._joint_bias = noise.encoder_bias * self._rng.standard_normal(12)
        tilt = noise.imu_bias * self._rng.standard_normal(2)
        self._imu_bias = geometry.quat_from_rotvec(np.append(tilt, 0.0))

    def reset(self, now: ControllerInput) -> None:
        """As the controller's."""
        self._controller.reset(self._felt(now))

    def act(self, now: ControllerInput) -> NDArray[np.float64]:
        """As the controller's."""
        return self._controller.act(self._felt(now))

    def _felt(self, now: ControllerInput) -> ControllerInput:
        robot, noise, rng = now.robot, self._noise, self._rng
        felt = replace(
            robot,
            joint_pos=robot.joint_pos + self._joint_bias + noise.encoder * rng.standard_normal(12),
            base_quat=geometry.quat_mul(robot.base_quat, self._imu_bias),
            base_ang_vel_b=robot.base_ang_vel_b + noise.gyro * rng.standard_normal(3),
        )
        return replace(now, robot=felt)
