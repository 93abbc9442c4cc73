"""What a robot behind a link does by itself: each row of its table, on a clock turned by hand."""

from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.control.controllers import PdPlayback
from studio.link.guards import LEANS
from studio.link.link import Level
from studio.link.robot_policy import RobotPolicy
from studio.link.robot_side import TO_BELLY, Heard, RobotSide
from studio.live.safety_of_robot import ROBOT_ROWS, robot_side
from studio.live.safety_table import page
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.robot import a1
from studio.robot.pose import RobotState
from studio.sim.world import World


class RobotBehind:
    """A robot's side on a clock, following orders until they stop; its body stays as it stands."""

    STEP = 1.0 / 240.0

    def __init__(self, level: Level) -> None:
        policy = RobotPolicy(PdPlayback()) if level == "references" else None
        self.side, self.robot, self.now = RobotSide(self.STEP, policy), World().state, 0.0
        stand = NEUTRAL["stand"]
        self.order = Heard(
            level=level, target=a1.STAND_JOINT_POS, reference=with_velocity(stand, stand)
        )
        self.side.set_down()
        for _ in range(30):
            self.side.hear(self.order, self.now)
            self.step()
        assert self.side.phase == "following"
        self.heard = self.now - self.STEP

    def step(self, robot: RobotState | None = None):
        self.now += self.STEP
        return self.side.step(robot or self.robot, self.now - self.STEP)

    def silent_until(self, phase: str) -> float:
        """s of silence after which it is in that phase."""
        for _ in range(round(20.0 / self.STEP)):
            self.step()
            if self.side.phase == phase:
                return self.now - self.STEP - self.heard
        raise AssertionError(f"never {phase}")


@pytest.mark.parametrize("row", ROBOT_ROWS, ids=lambda row: row.key)
def test_a_robot_behind_a_link_does_by_itself_what_its_table_says(row):
    robot = RobotBehind("references" if row.key == "silent_references" else "targets")
    if row.key in ("tilt", "not_finite"):
        over = geometry.quat_from_rpy([np.arcsin(LEANS) + 0.01, 0.0, 0.0])
        bad = {"tilt": {"base_quat": over}, "not_finite": {"joint_pos": np.full(12, np.nan)}}
        command = robot.step(replace(robot.robot, **bad[row.key]))
        assert (robot.side.phase, robot.side.why) == ("limp", row.key.replace("_", " "))
        assert np.isfinite(command.target).all()
    else:
        does = {"late": "holding", "silent_targets": "sitting", "silent_references": "halting"}
        assert abs(robot.silent_until(does[row.key]) - row.within) <= robot.STEP + 1e-6
        if row.latched:
            began = robot.silent_until("sitting") if row.key == "silent_references" else row.within
            assert robot.silent_until("limp") - began == pytest.approx(TO_BELLY, abs=0.02)
        command = robot.step()
    if row.latched:
        assert (command.kp, command.kd > 0.0) == (0.0, True)
    robot.side.hear(robot.order, robot.now)  # an order that does not ask it to rise
    robot.step()
    assert (robot.side.phase == "limp") is row.latched


def test_the_page_has_both_tables():
    assert robot_side() in page()
