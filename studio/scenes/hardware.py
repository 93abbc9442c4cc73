"""The paper's tasks on hardware: hit a ball 0.42 m high, touch a bone 0.8 m high, dodge a ball."""

from studio.scenes.body import CROUCH, RAISE, SIT
from studio.scenes.checks import dodged, touched_by_paw
from studio.scenes.scene import Scene, Step, Throw
from studio.scenes.things import BONE, hung_ball, thrown_ball
from studio.sim.props import PropShape

BONE_HUNG = PropShape(
    name="bone", kind="box", size=(0.12, 0.15, 0.03), pos=(1.3, 0.0, 0.8), held="hung", mass=0.12,
    color=BONE,
)  # fmt: skip

SCENE = Scene(
    name="hardware",
    title="Hardware set",
    about="What the paper's real robot did: hit a tennis ball, touch a bone, dodge a ball.",
    props=(hung_ball("tennis", 1.4, -0.13, 0.42, 0.0335), BONE_HUNG, thrown_ball()),
    scatter={"tennis": (0.02, 0.03, 0.0), "bone": (0.02, 0.03, 0.0)},
    steps=(
        Step(
            name="hit",
            goal="Hit the tennis ball, 0.42 m high, with a front paw.",
            body=RAISE,
            done=touched_by_paw("tennis"),
            within=90.0,
        ),
        Step(
            name="touch",
            goal="Touch the bone, 0.8 m high, with a front paw: you have to sit.",
            body=SIT,
            done=touched_by_paw("bone"),
            within=90.0,
        ),
        Step(
            name="dodge",
            goal="A ball will be thrown at you: crouch, so that it flies over.",
            body=CROUCH,
            done=dodged,
            within=40.0,
            throw=Throw(ball="ball", waits=(4.0, 5.0)),
        ),
    ),
)  # fmt: skip
