"""A robot on four feet tells the floor's slope; who sits down on it leans uphill, and stays."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.control import transition
from studio.control.floor_slope import FloorSlope
from studio.control.footing import feet_w
from studio.control.state_machine import StateMachine
from studio.puppeteer import Puppeteer
from studio.reference.sitting import UPHILL, lean_uphill
from studio.reference.stances import NEUTRAL
from studio.robot import kinematics
from studio.sim import randomize

STEEP = 0.13
"""rad: Table I's floors slope by 0.14 at most."""


def on_a_floor_that_rises_ahead(steep=STEEP):
    """A robot at rest on it, facing uphill, all else nominal."""
    puppeteer = Puppeteer()
    links = int(np.count_nonzero(puppeteer.stage.world.model.body_mass > 0.0))
    drawn = randomize.draw(np.random.default_rng(0), 1, links, scale=0.0)
    slope = np.array([[0.0, -steep]])  # nose up
    puppeteer.stage.world.set_dynamics(replace(drawn, slope_axis=slope))
    puppeteer.reset()
    return puppeteer


def test_standing_tells_how_much_the_floor_rises_ahead():
    puppeteer = on_a_floor_that_rises_ahead()
    for _ in range(90):
        puppeteer.step()
    assert puppeteer.floor.slope == pytest.approx([np.tan(STEEP), 0.0], abs=0.025)


def test_what_three_feet_and_broken_sensors_feel_changes_nothing():
    puppeteer = on_a_floor_that_rises_ahead()
    robot, machine = puppeteer.robot, StateMachine()
    floor = FloorSlope()
    spoilt = replace(robot, base_quat=np.full(4, np.nan))
    assert not floor.see(machine, spoilt).any()
    machine.reset("sit")
    assert not floor.see(machine, robot).any()
    machine.reset("stand")
    assert floor.see(machine, robot).any()


@pytest.mark.parametrize("slope", [(0.1, 0.0), (0.08, 0.06), (0.15, -0.1)])
def test_hips_move_uphill_while_feet_and_knees_stay_on_the_floor(slope):
    sit = NEUTRAL["sit"]
    out = lean_uphill(sit.joint_pos, sit.base_quat, np.array(slope))

    def com_over_feet(joint_pos):
        feet = geometry.quat_rotate(sit.base_quat, kinematics.foot_pos_b(joint_pos))[2:].mean(
            axis=0
        )
        com = geometry.quat_rotate(sit.base_quat, kinematics.center_of_mass_b(joint_pos))
        return com - feet

    before, after = com_over_feet(sit.joint_pos), com_over_feet(out)
    moved = after - before
    wanted = min(before[2] * slope[0], UPHILL)  # on level floor it is where it should be
    # The legs, which stay behind, weigh something, too.
    assert moved[:2] == pytest.approx([wanted, 0.0], rel=0.25, abs=1e-3)
    np.testing.assert_array_equal(out[:6], sit.joint_pos[:6])
    assert lean_uphill(sit.joint_pos, sit.base_quat, np.array([-0.1, 0.0])) is sit.joint_pos


def test_the_way_down_ends_uphill_on_the_same_feet():
    start = NEUTRAL["stand"]
    level = transition.plan(start, "stand", "sit")
    uphill = transition.plan(start, "stand", "sit", np.array([0.12, 0.0]))
    there, sat = (path.at(path.seconds) for path in (level, uphill))
    np.testing.assert_allclose(feet_w(sat)[2:], feet_w(there)[2:], atol=1e-6)
    assert 0.03 < sat.base_pos[0] - there.base_pos[0] < 0.06


@pytest.mark.parametrize("told", [True, False])
def test_sitting_on_a_steep_floor_holds_where_the_slope_is_known(told, monkeypatch):
    """Facing uphill, it tips backward over its knees where the hips stay as on level floor."""
    if not told:
        monkeypatch.setattr(FloorSlope, "see", lambda *_: np.zeros(2))
    puppeteer = on_a_floor_that_rises_ahead(0.18)
    for state, periods in (("stand", 60), ("sit", 240)):
        puppeteer.lock_state(state)
        for _ in range(periods):
            tick = puppeteer.step()
    assert tick.state == "sit"
    assert tick.fallen is not told
