"""The synthetic person who acts out what they are shown, as late as people are."""

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.mocap.operator import _Performed
from studio.mocap.performer import Person
from studio.mocap.performer import signals as sig
from studio.reference.intent import Intent

Array = NDArray[np.float64]


class FollowingOperator(_Performed):
    """Performs whatever `show` last gave, a period at a time. Endless; one thread."""

    def __init__(self, *, seed: int = 0, style: str = "march") -> None:
        person_rng, acting = np.random.default_rng(seed).spawn(2)
        person = Person.sample(person_rng, sensor="mocap", style=style).still()
        super().__init__("operator:follow", person, acting)
        self._row = sig.of_intents([Intent()])

    def show(self, intent: Intent) -> None:
        """What the person sees meant in this control period."""
        self._row = sig.of_intents([intent])

    def read(self, t: float) -> HumanPose | None:
        """The newest pose with time <= t (s) that was not given before."""
        due = self._due(t)
        if due <= self._given:
            return None
        rows = np.repeat(self._row, min(due - self._given, 300), axis=0)
        self._given = due
        seen, confidence, _, _ = self.performer.advance(rows)
        return HumanPose(t=due / 30.0, joint_pos_w=seen[-1], confidence=confidence[-1])
