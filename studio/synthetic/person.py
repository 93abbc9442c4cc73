"""A Person: body, habits and sensor, drawn from a seed; three families of movers."""

from dataclasses import dataclass, field, replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from studio.errors import unknown_name
from studio.synthetic.body import Body
from studio.synthetic.filters import movement_kernel
from studio.synthetic.habits import Habits, draw_habits, held_out_habits
from studio.synthetic.sensor import SENSORS, Sensor
from studio.synthetic.signals import DT
from studio.synthetic.wide import wide_body, wide_habits

Array = NDArray[np.float64]
Family = Literal["default", "held_out", "wide"]
FAMILIES: tuple[Family, ...] = ("default", "held_out", "wide")
MIXED = "mixed"
"""To learn from: half of the people of the default family, half of the wide one."""
HELD_OUT_SEED = 30_000
"""People who try what was trained are drawn from here on: no training draws from these seeds."""


def family_of(people: str, rng: np.random.Generator) -> str:
    """A family, or one of two for `MIXED`."""
    return str(rng.choice(["default", "wide"])) if people == MIXED else people


@dataclass(frozen=True, kw_only=True)
class Person:
    """Somebody. `reaction_delay` s from the intent to its motion, smoothing not included.

    `delay_s` is the whole lag, for aligning pairs. style: "march", "circles" or "semantic".
    """

    body: Body = field(default_factory=Body)
    habits: Habits = field(default_factory=Habits)
    sensor: Sensor = field(default_factory=Sensor)
    reaction_delay: float = 0.1
    family: Family = "default"
    style: str = "march"

    def follow_kernel(self) -> Array:
        """The reaction as a FIR kernel (K,) at 30 Hz: a pure delay, then the follow-up movement."""
        h = self.habits
        wait = np.zeros(round(self.reaction_delay / DT))
        return np.concatenate([wait, movement_kernel(h.follow_s, DT, h.profile)])

    @property
    def delay_s(self) -> float:
        """s by which the motion trails the intent: reaction and half the follow-up movement."""
        kernel = self.follow_kernel()
        return float(np.arange(len(kernel)) @ kernel) * DT

    def still(self) -> "Person":
        """The same person without idle gestures, as a mapper's pairs want them."""
        return replace(self, habits=replace(self.habits, idle_gesture_gap_s=float("inf")))

    @staticmethod
    def sample(
        rng: np.random.Generator,
        family: str = "default",
        *,
        sensor: str | None = None,
        style: str = "march",
    ) -> "Person":
        """Draw a person of a family, seen by a sensor (drawn too unless named).

        Raises StudioError for an unknown family or sensor.
        """
        if family not in FAMILIES:
            raise unknown_name("family", family, FAMILIES)
        body = Body.sample(rng)
        kind = sensor or str(rng.choice(list(SENSORS), p=[0.4, 0.25, 0.35]))
        habits = draw_habits(rng)
        if family == "held_out":
            habits = held_out_habits(rng, habits)
        if family == "wide":
            body, habits = wide_body(rng, body), wide_habits(rng, habits)
        return Person(
            body=body,
            habits=habits,
            sensor=Sensor.sample(rng, kind),
            reaction_delay=float(rng.uniform(0.0, 0.25)),
            family=family,
            style=style,
        )
