"""The task library: one file per task, each drawing random intents; `realize` makes them motion."""

from studio.reference.library import (
    crouch,
    manipulate_left,
    manipulate_right,
    march,
    quiet,
    sit_manipulate,
    sit_quiet,
    sit_tilt,
    tilt,
    tilt_manipulate,
    turn,
    walk,
)
from studio.reference.library.task import Task

TASKS: dict[str, Task] = {
    module.TASK.name: module.TASK
    for module in (
        quiet,
        tilt,
        crouch,
        manipulate_right,
        manipulate_left,
        tilt_manipulate,
        walk,
        turn,
        march,
        sit_quiet,
        sit_tilt,
        sit_manipulate,
    )
}
"""Every task by its name. A new task is a new file and a line here."""

__all__ = ["TASKS", "Task"]
