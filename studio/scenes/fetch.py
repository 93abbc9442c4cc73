"""Fetch: a ball has to be pushed into a goal."""

from studio.scenes.body import MARCH, STEER
from studio.scenes.checks import touched_by_robot, touches
from studio.scenes.scene import Scene, Step
from studio.scenes.things import BLUE, ORANGE
from studio.sim.props import PropShape

GOAL_X, HALF_WIDTH = 2.6, 0.6
BALL = PropShape(
    name="ball", kind="ball", size=(0.1,), pos=(1.0, 0.0, 0.1), held="free", mass=0.25,
    rolling=0.01, color=ORANGE,
)  # fmt: skip
NET = PropShape(
    name="net", kind="box", size=(0.02, HALF_WIDTH, 0.15), color=BLUE,
    pos=(GOAL_X + 0.4, 0.0, 0.15),
)  # fmt: skip
SIDES = tuple(
    PropShape(
        name=name, kind="box", size=(0.2, 0.02, 0.15), color=BLUE,
        pos=(GOAL_X + 0.2, side * HALF_WIDTH, 0.15),
    )
    for name, side in (("left", 1.0), ("right", -1.0))
)  # fmt: skip

SCENE = Scene(
    name="fetch",
    title="Fetch",
    about="Push the ball into the goal.",
    props=(BALL, NET, *SIDES),
    scatter={"ball": (0.1, 0.1, 0.0)},
    steps=(
        Step(
            name="reach",
            goal="Walk to the ball.",
            body=MARCH,
            done=touched_by_robot("ball"),
        ),
        Step(
            name="goal",
            goal="Push the ball into the goal, against its net.",
            body=STEER,
            done=touches("ball", "net"),
            within=120.0,
        ),
    ),
)
