"""Each rule of the robot's side, on a clock turned by hand; its legs go where they are sent."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.control.controllers import PdPlayback
from studio.link.engine import CROUCH
from studio.link.guards import JOINT_SLACK, Why
from studio.link.link import Level
from studio.link.robot_policy import RobotPolicy
from studio.link.robot_side import (
    HALT_AFTER,
    HOLD_AFTER,
    MAX_KD,
    MAX_KP,
    SIT_AFTER,
    STILL_WITHIN,
    TO_BELLY,
    TO_CROUCH,
    TO_STAND,
    Heard,
    RobotSide,
)
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.robot import a1, kinematics
from studio.robot.pose import RobotState

DT = 1.0 / 240.0
STAND = a1.STAND_JOINT_POS
STANDING = with_velocity(NEUTRAL["stand"], NEUTRAL["stand"])
RISES = TO_CROUCH + TO_STAND + 0.1


def at(joint_pos=STAND, quat=geometry.IDENTITY_QUAT, **changed) -> RobotState:
    pos = np.array([0.0, 0.0, 0.27])
    state = RobotState(
        base_pos=pos,
        base_quat=np.asarray(quat),
        joint_pos=np.asarray(joint_pos),
        foot_contact=np.ones(4),
        t=0.0,
        base_lin_vel_w=np.zeros(3),
        base_ang_vel_b=np.zeros(3),
        joint_vel=np.zeros(12),
        foot_pos_w=kinematics.foot_pos_w(pos, quat, joint_pos),
        torque=np.zeros(12),
    )
    return replace(state, **changed)


class Bench:
    """A robot on a clock: sends an order a period while `talks`, and keeps what the motors got."""

    def __init__(self, level: Level = "targets"):
        policy = RobotPolicy(PdPlayback()) if level == "references" else None
        self.side = RobotSide(DT, policy)
        self.now, self.robot = 100.0, at(CROUCH)
        self.order = Heard(level=level, target=STAND, reference=STANDING)
        self.talks, self.commands = True, []
        self._next = self.now

    def run(self, seconds):
        for _ in range(round(seconds / DT)):
            if self.talks and self.now >= self._next - 1e-9:
                self.side.hear(self.order, self.now)
                self._next = self.now + a1.CONTROL_DT
            command = self.side.step(self.robot, self.now)
            self.commands.append(command)
            self.robot = replace(self.robot, joint_pos=command.target)
            self.now += DT
        return self.side.phase

    def say(self, **changed):
        self.order = replace(self.order, **changed)
        self._next = self.now

    def rise(self):
        self.say(rise=self.order.rise + 1)
        return self.run(RISES)


def test_a_robot_that_is_switched_on_stays_limp_until_it_is_asked_to_rise():
    bench = Bench()
    assert bench.run(1.0) == "limp"
    assert bench.side.why == "switched on"
    assert all(command.kp == 0.0 and command.kd > 0.0 for command in bench.commands)
    assert bench.rise() == "following"


def test_it_rises_over_a_crouch_without_a_jump():
    bench = Bench()
    bench.robot = at(CROUCH + 0.1)
    bench.say(rise=1)
    assert bench.run(TO_CROUCH) == "rising"
    np.testing.assert_allclose(bench.side.target, CROUCH, atol=0.01)
    bench.run(TO_STAND + 0.1)
    np.testing.assert_allclose(bench.side.target, STAND, atol=1e-9)
    targets = np.array([command.target for command in bench.commands])
    # Minimum jerk peaks at 15/8 of the mean speed: 1.3 rad in 1.5 s, and 0.1 rad in 1 s.
    assert np.abs(np.diff(targets, axis=0)).max() / DT < 15 / 8 * 1.3


@pytest.mark.parametrize(
    ("robot", "why"),
    [
        (at(CROUCH, geometry.quat_from_rpy([1.0, 0.0, 0.0])), "tilt"),
        (at(a1.JOINT_UPPER + 2 * JOINT_SLACK), "joints"),
        (at(CROUCH, base_ang_vel_b=np.full(3, np.nan)), "not finite"),
    ],
)
def test_the_start_up_check_refuses_and_says_why(robot: RobotState, why: Why):
    bench = Bench()
    bench.robot = robot
    bench.say(rise=1)
    assert bench.run(0.2) == "limp"
    assert bench.side.why == why
    bench.robot = at(CROUCH)
    assert bench.run(0.5) == "limp", "what was refused is not done later, unasked"
    assert bench.rise() == "following"


def test_it_waits_two_seconds_for_legs_that_move_then_refuses():
    bench = Bench()
    sinking = at(CROUCH, joint_vel=np.full(12, 2.0))
    bench.robot = sinking
    bench.say(rise=1)
    assert bench.run(STILL_WITHIN - 0.1) == "limp"
    bench.robot = at(CROUCH)
    assert bench.run(0.1) == "rising"
    bench = Bench()
    bench.robot = sinking
    bench.say(rise=1)
    bench.run(STILL_WITHIN + 0.1)
    assert bench.side.why == "moving"
    bench.robot = at(CROUCH)
    assert bench.run(0.5) == "limp"


def test_silence_of_100_ms_holds_and_an_order_goes_on():
    bench = Bench()
    bench.rise()
    bench.say(target=STAND + 0.05)
    bench.run(1.0)
    bench.talks = False
    assert bench.run(HOLD_AFTER - a1.CONTROL_DT - 0.01) == "following"
    assert bench.run(0.1) == "holding"
    np.testing.assert_allclose(bench.side.target, STAND + 0.05)
    bench.talks = True
    assert bench.run(0.1) == "following"


def test_silence_of_half_a_second_sits_the_robot_down_then_damps_it():
    bench = Bench()
    bench.rise()
    bench.talks = False
    bench.run(SIT_AFTER["targets"] + 0.05)
    assert bench.side.phase == "sitting"
    assert bench.commands[-1].kp > 0.0
    bench.run(TO_BELLY)
    assert (bench.side.phase, bench.side.why) == ("limp", "line silent")
    np.testing.assert_allclose(bench.commands[-2].target, CROUCH, atol=0.01)
    assert bench.commands[-1].kp == 0.0
    bench.talks = True
    assert bench.run(2.0) == "limp", "a line that is back does not make it rise"
    assert bench.rise() == "following"


def test_orders_that_come_back_while_it_sits_down_are_not_followed():
    bench = Bench()
    bench.rise()
    bench.talks = False
    bench.run(SIT_AFTER["targets"] + 0.1)
    bench.talks = True
    assert bench.run(TO_BELLY + 0.1) == "limp"


@pytest.mark.parametrize("level", ["targets", "references"])
def test_a_stop_is_obeyed_in_the_same_step_in_every_phase_and_stays(level: Level):
    for before in (0.3, 1.5, RISES + 0.5):  # to the crouch, to the stand, following
        bench = Bench(level)
        bench.say(rise=1)
        bench.run(before)
        bench.say(stop=True)
        assert bench.run(DT) == "limp"
        assert bench.side.why == "asked to"
        bench.say(stop=False)
        assert bench.run(1.0) == "limp"
        assert bench.rise() == "following"


def test_a_rise_that_was_asked_for_before_a_stop_is_void():
    bench = Bench()
    bench.say(rise=1, stop=True)
    bench.run(0.1)
    bench.say(rise=1, stop=False)
    assert bench.run(0.5) == "limp"


@pytest.mark.parametrize(
    ("changed", "why"),
    [
        ({"base_quat": geometry.quat_from_rpy([1.2, 0.0, 0.0])}, "tilt"),
        ({"base_quat": geometry.quat_from_rpy([0.0, 1.2, 0.0])}, "tilt"),
        ({"base_quat": geometry.quat_from_rpy([np.pi, 0.0, 0.0])}, "tilt"),
        ({"joint_vel": np.full(12, np.inf)}, "not finite"),
        ({"base_quat": np.full(4, np.nan)}, "not finite"),
    ],
)
def test_a_tilt_and_what_is_no_number_damp_it_in_the_same_step(changed, why: Why):
    bench = Bench()
    bench.rise()
    good = bench.robot
    bench.robot = replace(bench.robot, **changed)
    assert bench.run(DT) == "limp"
    assert bench.side.why == why
    assert bench.commands[-1].kp == 0.0
    assert np.isfinite(bench.commands[-1].target).all()
    bench.robot = good
    assert bench.run(1.0) == "limp"


def test_a_sitting_trunk_is_no_fall():
    bench = Bench()
    bench.rise()
    bench.robot = replace(bench.robot, base_quat=NEUTRAL["sit"].base_quat)
    assert bench.run(0.5) == "following"


def test_targets_are_limited_on_the_robots_side():
    bench = Bench()
    bench.rise()
    bench.run(1.0)
    bench.say(target=np.full(12, 50.0), kp=1e6, kd=1e6)
    before = len(bench.commands)
    bench.run(1.0)
    targets = np.array([command.target for command in bench.commands[before - 1 :]])
    assert (targets <= a1.JOINT_UPPER + 1e-12).all()
    # However often it is told, no further in any period than the joint turns in two.
    period = round(a1.CONTROL_DT / DT)
    way = np.abs(targets[period:] - targets[:-period]).max()
    assert way <= 2 * a1.SPEED_LIMIT[0] * a1.CONTROL_DT + 1e-9
    assert (bench.commands[-1].kp, bench.commands[-1].kd) == (MAX_KP, MAX_KD)


def test_an_order_far_from_standing_is_not_followed_before_a_near_one_came():
    bench = Bench()
    bench.say(target=STAND + 0.6)
    assert bench.rise() == "standing"
    bench.say(target=STAND + 0.1)
    assert bench.run(0.5) == "following"
    np.testing.assert_allclose(bench.side.target, STAND + 0.1, atol=1e-9)


def test_another_driver_has_asked_for_nothing_yet():
    bench = Bench()
    bench.rise()
    bench.say(stop=True)
    bench.run(0.1)
    bench.side.new_driver()
    bench.say(stop=False, rise=0)
    assert bench.run(1.0) == "limp"
    assert bench.rise() == "following"


# References ---------------------------------------------------------------------------------


def test_references_are_followed_once_one_that_stands_has_come():
    bench = Bench("references")
    bench.say(state="walk")
    assert bench.rise() == "standing"
    bench.say(state="stand", in_transition=True)
    assert bench.run(0.3) == "standing"
    bench.say(in_transition=False)
    assert bench.run(0.3) == "following"


def test_references_that_end_bring_it_to_a_stand_and_are_followed_again():
    bench = Bench("references")
    bench.rise()
    crouched = STAND + np.tile([0.0, 0.15, -0.3], 4)
    bench.say(reference=replace(STANDING, joint_pos=crouched, base_pos=np.array([0.0, 0.0, 0.23])))
    bench.run(1.0)
    np.testing.assert_allclose(bench.side.target, crouched, atol=1e-3)
    bench.talks = False
    assert bench.run(HALT_AFTER - 0.05) == "holding"
    assert bench.run(0.1) == "halting"
    bench.run(3.0)
    assert bench.side.phase == "halting"
    np.testing.assert_allclose(bench.side.target, STAND, atol=1e-3)
    bench.say(reference=STANDING)
    bench.talks = True
    assert bench.run(0.2) == "following"


def test_it_waits_standing_for_references_then_sits_down():
    bench = Bench("references")
    bench.rise()
    bench.talks = False
    assert bench.run(SIT_AFTER["references"] - 0.1) == "halting"
    assert bench.run(0.2) == "sitting"
    assert bench.run(TO_BELLY) == "limp"


def test_references_are_not_followed_by_a_robot_without_policies():
    bench = Bench()
    bench.say(level="references")
    assert bench.rise() == "standing"


@pytest.mark.parametrize(("pitch_deg", "limp"), [(-70, False), (-105, False), (-120, True)])
def test_nose_up_it_may_sit_past_the_vertical_but_not_lie_on_its_back(pitch_deg, limp):
    bench = Bench()
    bench.rise()
    quat = geometry.quat_from_rpy([0.0, np.radians(pitch_deg), 0.0])
    bench.robot = replace(bench.robot, base_quat=quat)
    assert (bench.run(DT) == "limp") == limp
