"""Slalom: around three poles, left, right, left, and over the line."""

from studio.scenes.checks import past
from studio.scenes.scene import Scene, Step
from studio.scenes.things import mark, pole

FIRST, APART, WIDE = 2.5, 3.0, 1.2
"""m: to the first pole, between poles, and how far beside it a pole still counts as passed."""
SIDES = (1.0, -1.0, 1.0)
POLES = tuple(pole(f"pole{k + 1}", FIRST + k * APART, 0.0) for k in range(len(SIDES)))
END = FIRST + len(SIDES) * APART - 1.0


def _pass(k: int, side: float) -> Step:
    far = (0.0, WIDE) if side > 0.0 else (-WIDE, 0.0)
    which, way = ("first", "second", "third")[k], "left" if side > 0.0 else "right"
    return Step(
        name=f"pole{k + 1}",
        goal=f"Go past the {which} pole, keeping to its {way}.",
        body=f"March on the spot; twist your trunk to the {way} first, then back, and around.",
        done=past(FIRST + k * APART, far),
        within=90.0,
    )


SCENE = Scene(
    name="slalom",
    title="Slalom",
    about="Left, right, left of the poles; each touch costs points.",
    props=(*POLES, mark("mark", END, 0.0, 0.3)),
    avoid=tuple(p.name for p in POLES),
    scatter={p.name: (0.1, 0.05, 0.0) for p in POLES},
    steps=(
        *(_pass(k, side) for k, side in enumerate(SIDES)),
        Step(
            name="finish",
            goal="Cross the line of the mark.",
            body="March straight on.",
            done=past(END, (-1.5, 1.5)),
        ),
    ),
)
