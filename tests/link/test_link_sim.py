"""The link to a robot: the simulated one is its world, and any other stands where it stands."""

from dataclasses import replace

import numpy as np
import pytest

from studio.control.drive_command import Directive, DriveCommand, PuppeteerConfig
from studio.errors import StudioError
from studio.link.link import Order, RobotLink
from studio.link.sim import SimLink
from studio.puppeteer import Puppeteer
from studio.robot import a1
from studio.robot.pose import RobotPose, RobotState
from studio.scenes.stage import Stage
from studio.sim.world import World
from studio.synthetic.operator import OperatorSource

STAND = a1.STAND_JOINT_POS


class Elsewhere(RobotLink):
    """A robot that is not simulated here: it stands 2 m away and remembers what it was told."""

    name = "elsewhere"

    def __init__(self) -> None:
        self.there = replace(World().state, base_pos=np.array([2.0, -1.0, 0.27]))
        self.orders: list[Order] = []
        self.risen = 0
        self.busy = ""

    def sense(self) -> RobotState:
        return self.there

    def exchange(self, order: Order) -> RobotState:
        self.orders.append(order)
        return self.there

    def place(self, pose: RobotPose) -> RobotState:
        return self.there

    def rise(self) -> None:
        self.risen += 1

    def advise(self, command: DriveCommand) -> DriveCommand:
        return replace(command, directive=Directive.STAND) if self.busy else command

    @property
    def ready(self) -> bool:
        return not self.busy


def test_an_order_to_the_simulated_robot_is_a_period_of_its_world():
    world, other = World(), World()
    link = SimLink(world)
    rng = np.random.default_rng(0)
    for _ in range(10):
        target = STAND + rng.uniform(-0.1, 0.1, 12)
        np.testing.assert_array_equal(
            link.exchange(Order(target=target)).joint_pos, other.step(target).joint_pos
        )
        assert link.target is target
    assert link.sense() is world.state


def test_damping_reaches_the_motors_of_the_simulated_robot():
    link = SimLink(World())
    for _ in range(30):
        robot = link.exchange(Order(target=STAND, damping=True))
    assert robot.base_pos[2] < 0.2
    assert link.world.damping
    link.exchange(Order(target=STAND))
    assert not link.world.damping


def test_a_scene_with_props_is_refused_for_a_robot_that_is_elsewhere():
    with pytest.raises(StudioError, match="simulated robot, not elsewhere"):
        Stage("slalom", link=Elsewhere())
    stage = Stage("empty", link=Elsewhere())
    with pytest.raises(StudioError, match="use --robot sim"):
        stage.push([0.0, 0.0, 1.0], 0.1)


def test_the_flow_begins_where_another_robot_stands_and_sends_it_what_the_target_came_of():
    link, source = Elsewhere(), OperatorSource("sit_tilt", seed=0)
    puppeteer = Puppeteer(PuppeteerConfig(), link=link)
    np.testing.assert_allclose(puppeteer.state_machine.reference.base_pos[:2], [2.0, -1.0])
    ticks = [puppeteer.step(source.read(k / 30.0)) for k in range(60)]
    # Nobody can set it into the first voted state: it walks and sits down by itself.
    assert ticks[0].transition_to in (None, "sit")
    assert {tick.state for tick in ticks} <= {"stand", "transition"}
    last = link.orders[-1].asked
    assert last is not None
    assert last.reference is ticks[-1].reference
    assert last.in_transition == (ticks[-1].state == "transition")


def test_whoever_stands_up_asks_the_robot_to_rise():
    link = Elsewhere()
    puppeteer = Puppeteer(PuppeteerConfig(), link=link)
    assert link.risen == 0  # to connect moves nothing
    puppeteer.stand_up()
    assert link.risen == 1


def test_a_robot_that_is_not_ready_is_not_called_fallen():
    link = Elsewhere()
    link.busy = "rising"
    link.there = replace(link.there, trunk_contact=True)
    puppeteer = Puppeteer(PuppeteerConfig(), link=link)
    assert not puppeteer.step().fallen
    link.busy = ""
    assert puppeteer.step().fallen
