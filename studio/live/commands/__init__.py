"""Everything that may be asked of the control loop, one class a command, by what it is about."""

from studio.live.command import Command, Made, Result
from studio.live.commands.collect import AddToPlan, CollectAction, SetPlan
from studio.live.commands.drive import (
    MODES,
    Calibrate,
    SetController,
    SetGain,
    SetMirror,
    SetMode,
    SetSource,
    SetStateLock,
    SetSteps,
    SetTravel,
)
from studio.live.commands.mappers import MapperBack, SetMapper, SetStyle
from studio.live.commands.safety import Arm, Disarm, ReleaseControl, Reset, Stop, TakeControl
from studio.live.commands.scenes import PlaceRobot, Push, SetPerson, SetScene
from studio.live.commands.takes import Seek, ShowTake, StartTake, StopTake
from studio.live.commands.transport import Transport

COMMANDS: tuple[type[Command], ...] = tuple(Command.__subclasses__())
"""All of them, in the order of their declaration."""

__all__ = [
    "COMMANDS",
    "MODES",
    "AddToPlan",
    "Arm",
    "Calibrate",
    "CollectAction",
    "Command",
    "Disarm",
    "Made",
    "MapperBack",
    "PlaceRobot",
    "Push",
    "ReleaseControl",
    "Reset",
    "Result",
    "Seek",
    "SetController",
    "SetGain",
    "SetMapper",
    "SetMirror",
    "SetMode",
    "SetPerson",
    "SetPlan",
    "SetScene",
    "SetSource",
    "SetStateLock",
    "SetSteps",
    "SetStyle",
    "SetTravel",
    "ShowTake",
    "StartTake",
    "Stop",
    "StopTake",
    "TakeControl",
    "Transport",
]
