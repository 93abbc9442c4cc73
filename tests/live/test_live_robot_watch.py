"""A robot that is not simulated here, in the live loop: it moves when somebody arms, and its own
stops are the studio's."""

from dataclasses import replace
from pathlib import Path

import pytest
from fake_clock import FakeClock

from studio.control.drive_command import DriveCommand
from studio.errors import StudioError
from studio.link.link import Order, RobotLink
from studio.live import commands as c
from studio.live.loop import LiveLoop
from studio.live.runtime import Runtime, RuntimeConfig
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import RobotPose, RobotState
from studio.sim.world import World


class Elsewhere(RobotLink):
    """Stands; limp until it is asked to rise, if it is not made to go limp."""

    name = "elsewhere"

    def __init__(self) -> None:
        self.robot = World().state
        self.orders: list[Order] = []
        self.limp = "switched on"

    def sense(self) -> RobotState:
        return self.robot

    def exchange(self, order: Order) -> RobotState:
        self.orders.append(order)
        self.robot = replace(self.robot, t=self.robot.t + CONTROL_DT)
        return self.robot

    def place(self, pose: RobotPose) -> RobotState:
        return self.robot

    def rise(self) -> None:
        self.limp = ""

    def advise(self, command: DriveCommand) -> DriveCommand:
        return command

    @property
    def stopped(self) -> str:
        return f"the robot is limp ({self.limp})" if self.limp else ""


@pytest.fixture
def loop(tmp_path: Path) -> LiveLoop:
    config = RuntimeConfig(source="operator:crouch", sessions=tmp_path / "sessions")
    return LiveLoop(clock=FakeClock(), runtime=Runtime(config, link=Elsewhere()))


def link_of(loop: LiveLoop) -> Elsewhere:
    link = loop.runtime.puppeteer.link
    assert isinstance(link, Elsewhere)
    return link


def run(loop: LiveLoop, seconds: float) -> dict:
    for _ in range(round(seconds / CONTROL_DT)):
        loop.tick()
        loop.wait()
    return loop.state_dict()


def apply(loop: LiveLoop, command: c.Command) -> None:
    assert loop.post(command)
    loop.tick()
    loop.wait()


def drive(loop: LiveLoop) -> None:
    apply(loop, c.Reset())
    apply(loop, c.Arm())


def test_to_connect_moves_nothing_and_says_why(loop: LiveLoop):
    state = run(loop, 1.0)
    assert state["stopped"]
    assert state["reason"] == "robot"
    assert "limp (switched on); reset, then arm" in state["why"]
    assert all(order.damping for order in link_of(loop).orders[1:])


def test_reset_makes_it_rise_and_arm_makes_it_follow(loop: LiveLoop):
    run(loop, 0.5)
    drive(loop)
    assert link_of(loop).limp == ""
    state = run(loop, 3.0)
    assert (state["mode"], state["stopped"], state["why"]) == ("live", False, "")
    assert not link_of(loop).orders[-1].damping


def test_a_stop_of_its_own_is_latched_here(loop: LiveLoop):
    drive(loop)
    run(loop, 1.0)
    link_of(loop).limp = "tilt"
    state = run(loop, 0.1)
    assert state["stopped"]
    assert "(tilt)" in state["why"]
    assert link_of(loop).orders[-1].damping


def test_another_source_does_not_drive_it_before_somebody_arms(loop: LiveLoop):
    drive(loop)
    run(loop, 1.0)
    command = c.SetSource(source="operator:walk")
    command.apply(loop.runtime, loop.clock.now(), command.prepare(loop.runtime))
    state = run(loop, 1.0)
    assert (state["mode"], state["armed"]) == ("idle", False)


def test_its_line_is_not_silent_while_a_take_is_shown(loop: LiveLoop):
    drive(loop)
    run(loop, 0.5)
    apply(loop, c.StartTake(label="x"))
    run(loop, 1.0)
    apply(loop, c.StopTake())
    mode = c.SetMode(mode="replay")
    mode.apply(loop.runtime, loop.clock.now(), mode.prepare(loop.runtime))
    before = len(link_of(loop).orders)
    state = run(loop, 1.0)
    assert state["mode"] == "replay"
    assert len(link_of(loop).orders) == before + 30
    assert not link_of(loop).orders[-1].damping


def test_a_fallen_robot_waits_for_somebody_where_the_simulated_one_would_stand_up(loop: LiveLoop):
    drive(loop)
    run(loop, 1.0)
    link = link_of(loop)
    link.robot = replace(link.robot, trunk_contact=True)
    run(loop, 0.1)
    assert loop.state_dict()["reason"] == "fallen"
    link.limp, link.robot = "asked to", replace(link.robot, trunk_contact=False)
    state = run(loop, 5.0)
    assert state["stopped"]
    assert link.limp == "asked to"
    assert link.orders[-1].damping


def test_a_reset_does_not_make_a_standing_robot_crouch(loop: LiveLoop):
    drive(loop)
    run(loop, 1.0)
    apply(loop, c.Reset())
    asked = link_of(loop).orders[-1].asked
    assert asked is not None
    assert asked.reference.base_pos[2] > 0.2


def test_scenes_are_for_the_simulated_robot(loop: LiveLoop):
    result = c.SetScene(scene="push")
    with pytest.raises(StudioError, match="serve without --robot"):
        result.prepare(loop.runtime)
