"""Rough going: three steps of 3 cm, a slope down, and a floor of bumps."""

import numpy as np

from studio.scenes.body import MARCH, QUIETLY
from studio.scenes.checks import past
from studio.scenes.scene import Scene, Step
from studio.scenes.things import WOOD, mark
from studio.sim.props import PropShape

RISE, TREAD, HALF_WIDTH = 0.03, 0.45, 0.8
"""m, of a step; half the width of everything."""
STEPS_AT, TOP_AT, DOWN_AT, FLAT_AT = 1.0, 1.9, 2.6, 3.9
"""m along x: the first step, the landing, the slope, and its end."""
BUMPS_AT, BUMPS, EDGE, BUMP = 4.1, (10, 10), 0.16, 0.015
"""m, where bumps begin; how many along and across; m, the edge of one; the highest."""
END = BUMPS_AT + BUMPS[0] * EDGE + 0.3


def _stairs() -> list[PropShape]:
    return [
        PropShape(
            name=f"step{k + 1}", kind="box", held="ground", color=WOOD,
            size=(0.5 * (DOWN_AT - STEPS_AT - k * TREAD), HALF_WIDTH, 0.5 * RISE),
            pos=(0.5 * (DOWN_AT + STEPS_AT + k * TREAD), 0.0, (k + 0.5) * RISE),
        )
        for k in range(3)
    ]  # fmt: skip


def _slope() -> PropShape:
    """A plate from the landing's edge down to the floor."""
    high, long = 3 * RISE, FLAT_AT - DOWN_AT
    angle, thick = float(np.arctan2(high, long)), 0.01
    # The plate's upper face goes through (DOWN_AT, high) and (FLAT_AT, 0).
    x = 0.5 * (DOWN_AT + FLAT_AT) - thick * np.sin(angle)
    z = 0.5 * high - thick * np.cos(angle)
    return PropShape(
        name="slope", kind="box", held="ground", color=WOOD, rpy=(0.0, angle, 0.0),
        size=(0.5 * float(np.hypot(high, long)), HALF_WIDTH, thick), pos=(float(x), 0.0, float(z)),
    )  # fmt: skip


def _bumps() -> list[PropShape]:
    """Tiles of uneven height, the same in every run."""
    rng = np.random.default_rng(7)
    half, (along, across) = 0.5 * EDGE, BUMPS
    return [
        PropShape(
            name=f"bump{i}_{j}", kind="box", held="ground", color=WOOD,
            size=(half, half, 0.5 * high),
            pos=(BUMPS_AT + (i + 0.5) * EDGE, (j + 0.5 - 0.5 * across) * EDGE, 0.5 * high),
        )
        for i in range(along)
        for j in range(across)
        for high in [float(rng.uniform(0.002, BUMP))]
    ]  # fmt: skip


SCENE = Scene(
    name="rough",
    title="Rough going",
    about="Up three steps of 3 cm, down a slope of 4 degrees, over a floor of bumps.",
    props=(*_stairs(), _slope(), *_bumps(), mark("mark", END, 0.0, 0.3)),
    steps=(
        Step(
            name="stairs",
            goal="Climb the three steps.",
            body=MARCH,
            done=past(TOP_AT + 0.2, (-HALF_WIDTH, HALF_WIDTH)),
        ),
        Step(
            name="slope",
            goal="Go down the slope.",
            body=QUIETLY,
            done=past(FLAT_AT, (-HALF_WIDTH, HALF_WIDTH)),
        ),
        Step(
            name="bumps",
            goal="Cross the rough floor.",
            body=QUIETLY,
            done=past(END, (-HALF_WIDTH, HALF_WIDTH)),
        ),
    ),
)
