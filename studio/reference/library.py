"""The task library by name; `realize` makes the intents that a task draws a motion."""

from studio.reference.task import Task
from studio.reference.tasks_sit import SIT_TASKS
from studio.reference.tasks_stand import STAND_TASKS
from studio.reference.tasks_walk import WALK_TASKS

TASKS: dict[str, Task] = {task.name: task for task in (*STAND_TASKS, *WALK_TASKS, *SIT_TASKS)}
"""Every task by its name. A new task is a function and a line in its state's file."""

__all__ = ["TASKS", "Task", "task_names"]


def task_names(state: str) -> tuple[str, ...]:
    """The tasks of one state, in the library's own order: a curriculum's first axis."""
    return tuple(name for name, task in TASKS.items() if task.state == state)
