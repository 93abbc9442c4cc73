"""Exported policies, by their manifest alone, do what the studio's own do; and a second engine."""

import numpy as np
import pytest

from studio.control.controllers import ControllerInput, PolicyController
from studio.evaluation import sim2sim
from studio.evaluation.sim2sim import Case, ExportedPolicies, Options, run_sim2sim, track
from studio.reference.motion import with_velocity
from studio.reference.stances import NEUTRAL
from studio.sim.actuation import MotorTargets
from studio.sim.world import World


def test_exported_policies_say_what_the_shipped_ones_say():
    ours, theirs, motors = PolicyController(), ExportedPolicies(), MotorTargets()
    robot = World().state
    first = ControllerInput(
        reference=with_velocity(NEUTRAL["stand"], NEUTRAL["stand"]), robot=robot, state="stand"
    )
    for controller in (ours, theirs):
        controller.reset(first)
    motors.reset(robot.joint_pos)
    for _ in range(10):
        np.testing.assert_allclose(theirs.act(first), motors.step(ours.act(first)), atol=1e-5)


@pytest.mark.slow
def test_a_crouch_is_tracked_in_mujoco_by_the_files_as_in_training():
    run = track(Case(task="crouch", engine="mujoco", controller="policy"), 8.0, 100)
    assert not run.fell
    assert np.degrees(np.sqrt(run.joint_ms)) < 6.0


@pytest.mark.slow
def test_a_crouch_is_tracked_by_a_robot_nobody_trained_on():
    pytest.importorskip("pybullet")
    run = track(Case(task="crouch", engine="pybullet", controller="policy"), 8.0, 100)
    assert not run.fell
    assert np.degrees(np.sqrt(run.joint_ms)) < 8.0


def test_without_a_second_engine_there_are_rows_of_the_first(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(sim2sim, "TASKS", ("crouch",))
    monkeypatch.setattr(sim2sim, "CONTROLLERS", ("pd_playback",))
    monkeypatch.setattr(sim2sim, "find_spec", lambda name: None)
    (row,) = run_sim2sim(Options(episodes=1, seconds=1.0, threads=1), cache=None)["rows"]
    assert (row["engine"], row["task"], row["falls"]) == ("mujoco", "crouch", 0)
