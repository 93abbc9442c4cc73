"""The protocol between the flow and a robot: an order out and the robot's state in, each period.

    link.exchange(Order(target=…))   what the motors are to do, and the robot as it then is
    link.sense()                     the robot as it is now
    link.place(pose), link.rise()    a simulated robot is set somewhere; any other stands up itself

Limits, watchdog and guards are the robot's own affair (`link.robot_side`): nothing here is trusted
there.
"""

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.control.controllers import ControllerInput
from studio.control.drive_command import DriveCommand
from studio.errors import StudioError
from studio.robot import a1
from studio.robot.pose import RobotPose, RobotState
from studio.sim.world import World

Array = NDArray[np.float64]
Level = Literal["targets", "references"]
"""What crosses the link: PD targets of a policy that runs here, or references for one that runs on
the robot's side."""


@dataclass(frozen=True, kw_only=True)
class Order:
    """What a robot is to do in one control period.

    target: (12,) rad, for a PD with kp N m/rad and kd N m s/rad. asked: what the target came of,
    for a robot with a policy of its own; None where nothing is told of it. damping: no stiffness,
    whatever else is said.
    """

    target: Array
    kp: float = a1.KP
    kd: float = a1.KD
    asked: ControllerInput | None = None
    damping: bool = False


@dataclass(frozen=True, kw_only=True)
class Told:
    """What a robot behind a link last told of itself. phase, why: `robot_side.Phase`,
    `guards.Why`. heard_s: s since it told. refused: datagrams that were not believed."""

    phase: str
    why: str
    heard_s: float
    refused: int


class RobotLink(ABC):
    """One robot. The control loop's thread only.

    name: as `--robot` calls it. level: what crosses it. simulated: its robot lives in a world of
    the studio's. poses: it can be placed there in any pose. target: (12,) rad that its motors were
    last given, as far as is known.
    """

    name: str
    level: Level = "targets"
    simulated: bool = False
    poses: bool = False
    target: Array = a1.STAND_JOINT_POS

    @property
    def world(self) -> World:
        """The simulated robot's. StudioError where the robot is another."""
        raise StudioError(f"the robot at {self.name} is not in a world of ours: use --robot sim")

    def enter(self, world: World) -> None:  # noqa: B027 - only for a simulated one
        """The simulated robot lives in `world` from here on; no other one does."""

    @abstractmethod
    def sense(self) -> RobotState:
        """The newest state that is known."""

    @abstractmethod
    def exchange(self, order: Order) -> RobotState:
        """Give the order of this period; the newest state that is known then."""

    @abstractmethod
    def place(self, pose: RobotPose) -> RobotState:
        """A simulated robot at rest in `pose`; any other stays as it is. The state then."""

    def rise(self) -> None:  # noqa: B027 - a simulated one is placed
        """Whoever drives asks a robot that lies, or stopped itself, to stand up."""

    def advise(self, command: DriveCommand) -> DriveCommand:
        """The command of this period, or to stand where the robot is not ready to be driven."""
        return command

    @property
    def ready(self) -> bool:
        """The robot does what it is told."""
        return True

    @property
    def stopped(self) -> str:
        """Why the robot stopped itself and waits to be asked to rise; "" where it did not."""
        return ""

    @property
    def told(self) -> Told | None:
        """What the robot last told; None for a simulated one."""
        return None

    def close(self) -> None:  # noqa: B027 - most hold nothing
        """Let go of the robot."""
