"""The operator: the synthetic person as sources; touring, at one task, by hand, or shown."""

import copy
import threading
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from studio.errors import unknown_name
from studio.human.pose import HumanPose
from studio.mocap.source import Source
from studio.reference.intent import Intent
from studio.synthetic import Performance, Performer, Person, perform, play
from studio.synthetic import signals as sig
from studio.synthetic.signals import DT
from studio.synthetic.tour import tour_signal

__all__ = [
    "FollowingOperator",
    "InteractiveOperator",
    "OperatorSource",
    "Performance",
    "Performer",
    "Person",
    "perform",
    "play",
]

Array = NDArray[np.float64]
_BLOCK = 120  # frames performed ahead, a third of the cost of 30; a script knows its own future
_REPEAT_S = 12.0  # s of a task drawn at a time


class _Performed(Source):
    """What all operators share: a person performing one frame after another on a 30 Hz clock."""

    starts_live = True
    duration: float | None = None

    def __init__(self, name: str, person: Person, rng: np.random.Generator) -> None:
        self.name, self.person = name, person
        acting, self._quiet_rng = rng.spawn(2)
        self.performer = Performer(person, acting)
        self._given = -1

    def _due(self, t: float) -> int:
        """Index of the newest frame with time <= t, half a period of tolerance."""
        return int(np.floor(t / DT + 0.5))

    def set_style(self, style: str) -> None:
        """Mean walking by another motion from the next pose on (the thread that reads)."""
        self.performer.set_style(style)
        self.person = self.performer.person

    def stand_in(self, *, seed: int, style: str) -> Source | None:
        """Another synthetic person, who looks at what is shown."""
        return FollowingOperator(seed=seed, style=style)

    def calibration_poses(self) -> list[HumanPose]:
        """Two seconds of the same person standing quietly, as a careful user would begin."""
        quiet = np.zeros((60, sig.NUM))
        clip = play(quiet, self.person.still(), self._quiet_rng, "quiet").clip
        return [clip[i] for i in range(0, len(clip), 3)]

    def close(self) -> None:
        """Nothing is held."""


class OperatorSource(_Performed):
    """The synthetic person touring every task (`task` None) or repeating one. Endless."""

    def __init__(
        self,
        task: str | None = None,
        *,
        seed: int = 0,
        style: str = "march",
        sensor: str = "mocap",
    ) -> None:
        """sensor: as in `Person.sample`; a good studio's unless a table asks for a worse one.

        Raises StudioError for a task the reference library does not have.
        """
        person_rng, acting, self._script_rng = np.random.default_rng(seed).spawn(3)
        person = Person.sample(person_rng, sensor=sensor, style=style).still()
        super().__init__("operator" if task is None else f"operator:{task}", person, acting)
        self.tours = task is None
        self._more = self._touring() if task is None else self._repeating(task)
        self._script = np.zeros((0, sig.NUM))
        self._block: list[HumanPose] = []
        self._first = 0
        self._before = (self.performer, np.zeros((0, sig.NUM)))

    @property
    def label(self) -> str:
        """ "operator tour", or the task."""
        return "operator tour" if self.tours else super().label

    def read(self, t: float) -> HumanPose | None:
        """The newest pose with time <= t (s) that was not given before."""
        due = self._due(t)
        if due <= self._given:
            return None
        while due >= self._first + len(self._block):
            self._perform_block()
        self._given = due
        return self._block[due - self._first]

    def _perform_block(self) -> None:
        self._first += len(self._block)
        while len(self._script) < _BLOCK:
            self._script = np.concatenate([self._script, self._more()])
        rows, self._script = self._script[:_BLOCK], self._script[_BLOCK:]
        self._before = (copy.deepcopy(self.performer), rows)
        self._block = self._performed(rows, self._first)

    def _performed(self, rows: Array, first: int) -> list[HumanPose]:
        seen, confidence, _, _ = self.performer.advance(rows)
        return [
            HumanPose(t=(first + i) * DT, joint_pos_w=seen[i], confidence=confidence[i])
            for i in range(len(rows))
        ]

    def set_style(self, style: str) -> None:
        """As for all; what was performed ahead is performed again from here on."""
        self.performer, rows = self._before
        given = int(np.clip(self._given + 1 - self._first, 0, len(rows)))
        if given:
            self.performer.advance(rows[:given])
        super().set_style(style)
        self._first += given
        self._before = (copy.deepcopy(self.performer), rows[given:])
        self._block = self._performed(rows[given:], self._first) if given < len(rows) else []

    def _touring(self) -> Callable[[], Array]:
        signal, _ = tour_signal()
        return lambda: signal

    def _repeating(self, task: str) -> Callable[[], Array]:
        from studio.reference.library import TASKS

        if task not in TASKS:
            raise unknown_name("task", task, TASKS)
        return lambda: sig.of_track(TASKS[task].sample(self._script_rng, _REPEAT_S))


class InteractiveOperator(_Performed):
    """The synthetic person doing what keys, a gamepad or a script last asked for.

    `set_intent` may be called from any thread; `read` only from the loop's.
    """

    _EASE_S = 0.6  # s over which the person eases from one intent to the next

    def __init__(
        self, *, seed: int = 0, style: str = "march", family: str = "default", sensor: str = "mocap"
    ) -> None:
        """family, sensor: as in `Person.sample`."""
        person_rng, acting = np.random.default_rng(seed).spawn(2)
        person = Person.sample(person_rng, family, sensor=sensor, style=style).still()
        super().__init__("operator:interactive", person, acting)
        self._lock = threading.Lock()
        self._wanted = Intent()
        self._signal = np.zeros(sig.NUM)
        self._speed = np.zeros(sig.NUM)

    @property
    def label(self) -> str:
        """Keys are what drives it as a rule."""
        return "keyboard"

    def set_intent(self, intent: Intent) -> None:
        """From now on this is meant; the latest wins. Its phase is ignored: cadence drives it."""
        with self._lock:
            self._wanted = intent

    def read(self, t: float) -> HumanPose | None:
        """The newest pose with time <= t (s) that was not given before."""
        due = self._due(t)
        if due <= self._given:
            return None
        with self._lock:
            wanted = sig.of_intents([self._wanted])[0]
        rows = np.stack([self._ease(wanted) for _ in range(min(due - self._given, 300))])
        self._given = due
        seen, confidence, _, _ = self.performer.advance(rows)
        return HumanPose(t=due * DT, joint_pos_w=seen[-1], confidence=confidence[-1])

    def _ease(self, wanted: Array) -> Array:
        """One period of a critically damped approach; phase runs on with the eased cadence."""
        phase = self._signal[sig.PHASE]
        rate = 4.0 / self._EASE_S
        # Exact step of x'' = rate^2 (goal - x) - 2 rate x'.
        gap, decay = self._signal - wanted, np.exp(-rate * DT)
        mix = (self._speed + rate * gap) * DT
        self._signal = wanted + (gap + mix) * decay
        self._speed = (self._speed - rate * mix) * decay
        self._signal[[sig.WALK, sig.SIT]] = wanted[[sig.WALK, sig.SIT]]
        self._signal[sig.PHASE] = phase + self._signal[sig.CADENCE] * DT
        self._speed[sig.PHASE] = 0.0
        return self._signal.copy()


class FollowingOperator(_Performed):
    """The synthetic person who acts out what they are shown, as late as people are.

    Performs what `show` gives, a period each: its clock is what it is shown, so that a loop that
    is late slows both alike. Endless; one thread.
    """

    def __init__(self, *, seed: int = 0, style: str = "march") -> None:
        person_rng, acting = np.random.default_rng(seed).spawn(2)
        person = Person.sample(person_rng, sensor="mocap", style=style).still()
        super().__init__("operator:follow", person, acting)
        self._row: Array | None = None

    def stand_in(self, *, seed: int, style: str) -> Source | None:
        """Nobody: this one acts."""
        return None

    def show(self, intent: Intent) -> None:
        """What the person sees meant in this control period."""
        self._row = sig.of_intents([intent])

    def read(self, t: float) -> HumanPose | None:
        """The pose of the period shown last, once."""
        if self._row is None:
            return None
        self._given += 1
        seen, confidence, _, _ = self.performer.advance(self._row)
        self._row = None
        return HumanPose(t=self._given * sig.DT, joint_pos_w=seen[0], confidence=confidence[0])
