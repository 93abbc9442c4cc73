"""The robot and its reference come apart as it walks; armed, or at a take's start, they meet."""

import numpy as np
import pytest
from fake_clock import FakeClock
from turning import DT, ask, run

from studio import geometry
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.live.shown_motion import PlanItem


@pytest.fixture
def loop(tmp_path):
    loop = LiveLoop(
        clock=FakeClock(),
        runtime=Runtime(RuntimeConfig(source="operator:walk", sessions=tmp_path / "sessions")),
    )
    yield loop
    loop.runtime.close()


def planned(loop, **options):
    item = PlanItem(task="crouch", takes=1, seconds=3.0)
    assert ask(loop, c.SetPlan(items=(item,), seed=0, preview=False, **options)).ok
    assert ask(loop, c.SetMode(mode="collect")).ok


def collect(loop):
    return loop.state_dict()["collect"]


def apart(tick):
    """m and rad between the reference and the robot along the floor."""
    reference, robot = tick.reference, tick.robot
    turned = geometry.heading(reference.base_quat) - geometry.heading(robot.base_quat)
    distance = np.linalg.norm((reference.base_pos - robot.base_pos)[:2])
    return float(distance), abs(float(geometry.wrap_angle(turned)))


def test_a_take_begins_with_the_robot_where_its_reference_is(loop):
    before = run(loop, 10.0)[-1]
    loop.runtime.puppeteer.stage.world.move_base(before.robot.base_pos[:2] + [1.0, 4.0], 2.0)
    assert apart(run(loop, DT)[-1])[0] > 3.0
    assert ask(loop, c.StartTake()).ok
    tick = loop.ticks.get()
    distance, angle = apart(tick)
    assert distance < 0.05  # a period of walking
    assert angle < np.radians(5.0)
    assert not any(tick.fallen for tick in run(loop, 3.0))


def test_arming_brings_the_robot_back_to_its_reference(loop):
    run(loop, 1.0)
    assert ask(loop, c.Stop()).ok
    assert ask(loop, c.Reset()).ok
    run(loop, 2.0)
    loop.runtime.puppeteer.stage.world.move_base([5.0, 5.0], -2.0)
    assert ask(loop, c.Arm()).ok
    distance, angle = apart(loop.ticks.get())
    assert distance < 0.02
    assert angle < np.radians(2.0)


def test_a_collected_take_begins_in_place(loop):
    planned(loop)
    loop.runtime.puppeteer.stage.world.move_base([2.0, -3.0], 1.0)
    assert ask(loop, c.CollectAction(action="go")).ok
    while collect(loop)["phase"] != "record":
        run(loop, DT)
    distance, angle = apart(loop.ticks.get())
    assert distance < 0.02
    assert angle < np.radians(2.0)
