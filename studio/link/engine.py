"""A robot's motors and sensors, a short step at a time: what the robot's side drives."""

from abc import ABC, abstractmethod
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from studio import geometry
from studio.robot import a1
from studio.robot.pose import RobotPose, RobotState
from studio.sim.spec import ModelConfig
from studio.sim.world import World, WorldConfig

Array = NDArray[np.float64]
RATES = (240, 500)
"""1/s: the slowest and the fastest that an engine may step. A real A1's motors take 500."""
CROUCH = np.tile([0.0, 1.2915, -2.583], 4)
"""Legs folded: the trunk 13 cm high, 2 * 0.2 cos(1.2915) = 0.11 m over the soles."""
LYING = RobotPose(
    base_pos=np.zeros(3),
    base_quat=geometry.IDENTITY_QUAT,
    joint_pos=CROUCH,
    foot_contact=np.ones(4),
)
"""As robots are switched on."""


@dataclass(frozen=True, kw_only=True)
class MotorCommand:
    """target: (12,) rad. kp N m/rad, kd N m s/rad: of the PD law; kp = 0 only damps."""

    target: Array
    kp: float
    kd: float


class Engine(ABC):
    """One robot. One thread. dt: s of a step."""

    dt: float

    @abstractmethod
    def state(self) -> RobotState:
        """As it is now."""

    @abstractmethod
    def step(self, command: MotorCommand) -> RobotState:
        """`dt` s under this command, torques within ±33.5 N m; the state then."""

    @abstractmethod
    def place(self, pose: RobotPose) -> RobotState:
        """Somebody sets it down at rest in `pose`: for simulated ones only."""

    def close(self) -> None:  # noqa: B027 - most hold nothing
        """Let go of what it holds."""


class MujocoEngine(Engine):
    """The A1 that the policies were trained on, or that of a scene's world."""

    def __init__(self, world: World | None = None, rate: int = RATES[0]) -> None:
        """rate: 1/s, of a world of its own."""
        model = ModelConfig(timestep=1.0 / rate)
        self.world = World(WorldConfig(model=model)) if world is None else world
        self.dt = self.world.config.model.timestep
        self._gains: tuple[float, float] | None = None
        if world is None:
            self.place(LYING)

    def state(self) -> RobotState:
        """As the world last said."""
        return self.world.state

    def step(self, command: MotorCommand) -> RobotState:
        """One physics step."""
        gains = command.kp, command.kd
        if gains != self._gains:
            self.world.set_gains(*gains)
            self._gains = gains
        return self.world.step(command.target, 1)

    def place(self, pose: RobotPose) -> RobotState:
        """Lowest point on the floor."""
        self._gains = None
        self.world.set_gains(a1.KP, a1.KD)
        return self.world.reset(pose)
