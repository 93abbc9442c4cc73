"""The paper's second composite task: walk to a box, and push it to a mark, again and again."""

from studio.scenes.body import MARCH, STEER
from studio.scenes.checks import prop_near, touched_by_robot
from studio.scenes.scene import Scene, Step
from studio.scenes.things import WOOD, mark
from studio.sim.props import PropShape

BOX = PropShape(
    name="box", kind="box", size=(0.2, 0.25, 0.2), pos=(1.5, 0.0, 0.2), held="free", mass=1.0,
    friction=0.3, overhang=(0.12, 0.15), color=WOOD,
)  # fmt: skip
"""On a narrower foot, so that the body pushes it, and not one foot after the other."""
GOAL, RADIUS = (2.3, 0.0), 0.3

SCENE = Scene(
    name="push",
    title="Push the box",
    about="A box far off has to come to the mark: walk to it, and push.",
    props=(mark("mark", *GOAL, RADIUS), BOX),
    scatter={"box": (0.1, 0.08, 0.0)},
    steps=(
        Step(
            name="walk",
            goal="Walk to the box.",
            body=MARCH,
            done=touched_by_robot("box"),
        ),
        Step(
            name="push",
            goal="Push the box onto the mark, its middle inside, and leave it there.",
            body=f"{STEER} Once the box is on the mark, stand still.",
            done=prop_near("box", *GOAL, RADIUS),
            hold=3.0,
            within=120.0,
        ),
    ),
)
