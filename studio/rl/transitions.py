"""Two states → reference motions out of one into the other, as the state machine leads them.

A transition begins in the period in which the goal's policy takes over: a planned way of 1 to 3 s
out of whatever the robot was doing, then a motion of the goal's own tasks, eased into.
"""

import numpy as np

from studio.control.state_machine import StateMachine
from studio.reference.intent import IntentTrack, StateName
from studio.reference.library import TASKS, task_names
from studio.reference.motion import ReferenceMotion
from studio.reference.realize import Realizer
from studio.robot import a1
from studio.robot.pose import ReferencePose

SOURCES: dict[StateName, tuple[StateName, ...]] = {
    "stand": ("walk", "sit"),
    "walk": ("stand",),
    "sit": ("stand",),
}
"""Where a state is entered from; walking and sitting are joined through standing."""
BEFORE_S = (0.8, 3.0)
"""s of the source's own motion before the goal is asked for."""


def transition_names(goal: StateName) -> tuple[str, ...]:
    """The transitions into a state, as tasks of its bank."""
    return tuple(f"from_{source}" for source in SOURCES[goal])


def rests_on_legs(goal: StateName) -> bool:
    """Whether calves touch the floor on some way into the state."""
    return goal == "sit" or "sit" in SOURCES[goal]


def transition_motion(
    source: StateName,
    goal: StateName,
    rng: np.random.Generator,
    seconds: float,
    difficulty: float = 1.0,
) -> ReferenceMotion:
    """One motion of `seconds` s out of a random pose of `source` into a random task of `goal`."""
    machine = StateMachine()
    machine.reset(source)
    actor = _Actor(machine)
    before = _draw(source, rng, BEFORE_S[1] + 1.0, difficulty)
    after = _draw(goal, rng, seconds + 0.5, difficulty)
    for _ in range(int(rng.uniform(*BEFORE_S) / a1.CONTROL_DT)):
        machine.step(source, actor.reference(before))
    poses: list[ReferencePose] = []
    frames = round(seconds / a1.CONTROL_DT) + 1
    while len(poses) < frames:
        arrived = machine.state == goal and not machine.in_transition
        now = after if arrived else before
        decision = machine.step(goal, actor.reference(now))
        if decision.expert == goal:
            poses.append(decision.reference)
    return ReferenceMotion.of(goal, f"from_{source}", poses)


def _draw(
    state: StateName, rng: np.random.Generator, seconds: float, difficulty: float
) -> IntentTrack:
    return TASKS[str(rng.choice(task_names(state)))].sample(rng, seconds, difficulty)


class _Actor:
    """Realises tracks from where the state machine is, as the retargeter does."""

    def __init__(self, machine: StateMachine) -> None:
        self._machine, self._realizer = machine, Realizer()
        self._track: IntentTrack | None = None
        self._next = 0

    def reference(self, track: IntentTrack) -> ReferencePose:
        """The next pose of a track; a new one begins where the state machine's feet stand."""
        if track is not self._track or not self._machine.following:
            if track is not self._track:
                self._track, self._next = track, 0
            x, y, _ = self._machine.reference.base_pos.tolist()
            self._realizer.reset(x, y, self._machine.facing)
        pose = self._realizer.step(track[min(self._next, len(track) - 1)])
        if self._machine.following:
            self._next += 1
        return pose
