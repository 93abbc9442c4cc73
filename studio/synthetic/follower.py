"""The synthetic person who acts out what they are shown, as late as people are."""

import numpy as np
from numpy.typing import NDArray

from studio.human.pose import HumanPose
from studio.reference.intent import Intent
from studio.synthetic import Person
from studio.synthetic import signals as sig
from studio.synthetic.operator import _Performed

Array = NDArray[np.float64]


class FollowingOperator(_Performed):
    """Performs what `show` gives, a period each: its clock is what it is shown, so that a loop that
    is late slows both alike. Endless; one thread."""

    def __init__(self, *, seed: int = 0, style: str = "march") -> None:
        person_rng, acting = np.random.default_rng(seed).spawn(2)
        person = Person.sample(person_rng, sensor="mocap", style=style).still()
        super().__init__("operator:follow", person, acting)
        self._row: Array | None = None

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
