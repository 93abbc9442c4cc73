"""The paper's first composite task: greet, walk 3 m, dodge a ball, touch one target, then one 0.8 m
high, which can only be reached sitting."""

from studio.scenes.body import CROUCH, LEAN, ON_MARK, RAISE, SIT
from studio.scenes.checks import dodged, stands_near, tilted, touched_by_paw
from studio.scenes.scene import Scene, Step, Throw
from studio.scenes.things import BONE, hung_ball, mark, thrown_ball
from studio.sim.props import PropShape

HIGH = PropShape(
    name="high", kind="cylinder", size=(0.12, 0.02), pos=(3.3, 0.0, 0.8), held="hung", mass=0.15,
    color=BONE,
)  # fmt: skip

SCENE = Scene(
    name="greeting",
    title="Greeting",
    about="Greet, cross the room, duck, and touch what hangs low and high.",
    props=(mark("mark", 3.0, 0.0, 0.4), hung_ball("target", 3.55, 0.0, 0.25, 0.09), HIGH,
           thrown_ball()),
    scatter={"target": (0.0, 0.06, 0.02), "high": (0.02, 0.04, 0.0)},
    steps=(
        Step(
            name="greet",
            goal="Greet: lean to a side, forward or back, by 12 degrees.",
            body=LEAN,
            done=tilted(12.0),
            hold=0.3,
            within=20.0,
        ),
        Step(
            name="walk",
            goal="Walk the 3 m to the mark, and stand on it.",
            body=ON_MARK,
            done=stands_near(3.0, 0.0, 0.4),
            hold=0.5,
        ),
        Step(
            name="dodge",
            goal="A ball will be thrown at you: crouch, so that it flies over.",
            body=CROUCH,
            done=dodged,
            within=30.0,
            throw=Throw(ball="ball"),
        ),
        Step(
            name="touch",
            goal="Touch the green ball with a front paw.",
            body=RAISE,
            done=touched_by_paw("target"),
        ),
        Step(
            name="reach",
            goal="Sit, and touch the plate that hangs 0.8 m high with a front paw.",
            body=SIT,
            done=touched_by_paw("high"),
            within=90.0,
        ),
    ),
)  # fmt: skip
