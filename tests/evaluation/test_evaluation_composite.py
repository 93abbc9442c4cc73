"""The scripted operator: sees late, drives by human motion alone, and is counted honestly."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from studio.evaluation import composite as co
from studio.evaluation.scene_operator import REACTION_S, Eyes, ScriptedOperator
from studio.evaluation.scene_ways import walking
from studio.human.pose import HumanPose
from studio.link.link import Order
from studio.reference.intent import Intent
from studio.reference.sitting import sit_poses
from studio.reference.stances import NEUTRAL
from studio.reference.standing import stand_poses
from studio.robot import a1
from studio.robot.a1 import CONTROL_DT
from studio.robot.pose import RobotPose
from studio.scenes import greeting
from studio.scenes.stage import Stage
from studio.takes.record.recorder import Recorder
from studio.takes.take import read_take
from studio.takes.tick import Tick

PUSH = co.Job(scene="push", controller="policy", style="march", seed=0)


def run_of(*done: float, failed: str = "") -> co.Run:
    return co.Run(steps=("walk", "push"), done=done, score=100, failed=failed, seconds=20.0)


def test_what_is_seen_of_the_page_is_a_reaction_late() -> None:
    stage = Stage("push")
    stage.reset(NEUTRAL["stand"])
    eyes = Eyes(stage, np.random.default_rng(0))
    shown = []
    for k in range(30):
        if k == 10:
            stage.world.move_base([0.5, 0.0], 0.0)
        shown.append(eyes.see(Intent()).base[0] > 0.25)
    assert shown.index(True) == 10 + round(REACTION_S / CONTROL_DT)


def test_a_play_begins_with_its_step_and_whoever_has_no_more_to_try_stands() -> None:
    def once(me: ScriptedOperator):
        yield Intent(crouch=1.0)

    stage = Stage("push")
    stage.reset(NEUTRAL["stand"])
    eyes, operator = Eyes(stage, np.random.default_rng(0)), ScriptedOperator({"walk": once})
    meant = [operator.mean(eyes.see(Intent())) for _ in range(3)]
    assert [intent.crouch for intent in meant] == [1.0, 0.0, 0.0]


def test_who_sees_a_place_to_the_left_turns_left_and_no_more_than_a_person_can() -> None:
    assert walking(np.array([1.0, 0.0])).turn == 0.0
    assert walking(np.array([1.0, 0.2])).turn > 0.0
    assert walking(np.array([0.0, -5.0])).turn == pytest.approx(-0.45)


def test_a_share_of_few_runs_has_a_wide_interval() -> None:
    assert co.share_ci(20, 20) == (pytest.approx(0.8316, abs=1e-4), 1.0)  # .025 ** (1 / 20)
    assert co.share_ci(0, 5) == (0.0, pytest.approx(0.5218, abs=1e-4))  # 1 - .025 ** (1 / 5)
    low, high = co.share_ci(3, 5)
    assert low < 0.6 < high


def test_rows_tell_every_run_and_every_step() -> None:
    group = [PUSH, co.Job(scene="push", controller="policy", style="march", seed=1)]
    runs = [run_of(4.0, 9.0), run_of(5.0, failed="out of time")]
    whole = co._whole(group, runs)
    assert (whole["case"], whole["step"], whole["view"]) == ("push", "all", "third_person")
    assert (whole["done"], whole["seconds"], whole["goal"]) == (0.5, 9.0, 0.95)
    assert whole["steps_done"] == {"walk": 1.0, "push": 0.5}
    assert whole["failed"] == {"out of time": 1}
    first, second = ([*co._steps(job, run)] for job, run in zip(group, runs, strict=True))
    assert [(row["step"], row["done"], row["seconds"]) for row in first] == [
        ("walk", True, 4.0), ("push", True, 5.0),
    ]  # fmt: skip
    assert [(row["done"], row["failed"]) for row in second] == [(True, ""), (False, "out of time")]


def test_the_recorded_human_motion_alone_gives_the_same_run_again(tmp_path: Path) -> None:
    """One scripted attempt at the box, its tape played into another puppeteer of the same seed."""
    ticks: list[Tick] = []
    recorder = Recorder(tmp_path)
    name = recorder.start("attempt")

    def keep(tick: Tick) -> None:
        ticks.append(tick)
        recorder.append(tick)

    made = co.attempt(PUSH, keep)
    recorder.close()
    assert made.failed == ""
    assert len(made.done) == 2
    # Limits hold while it pushes.
    targets = np.array([tick.target for tick in ticks])
    torques = np.array([tick.robot.torque for tick in ticks])
    assert np.all((targets >= a1.JOINT_LOWER) & (targets <= a1.JOINT_UPPER))
    assert np.all(np.abs(torques) <= 1.01 * a1.TORQUE_LIMIT)

    take = read_take(tmp_path / name)
    fresh = set(take.human_tick.tolist())
    poses: list[HumanPose | None] = [
        tick.human if n in fresh else None for n, tick in enumerate(take.ticks)
    ]
    again: list[Tick] = []
    assert co.play(co.puppeteer_of(PUSH), poses.__getitem__, again.append) == made
    assert np.array_equal(again[-1].robot.base_pos, ticks[-1].robot.base_pos)
    assert np.array_equal(again[-1].robot.joint_pos, ticks[-1].robot.joint_pos)


@pytest.mark.slow
def test_nobody_who_stands_still_comes_anywhere() -> None:
    job = co.Job(scene="push", controller="stand_still", style="march", seed=0)
    run = co.attempt(job)
    assert run.done == ()
    assert run.failed in ("nothing happened", "out of time")


def reaches(pose: RobotPose, joints: np.ndarray, x: float) -> bool:
    """Whether a robot that begins at x m and holds these joints, one after another, touches."""
    stage = Stage("greeting", seed=1)
    at = np.append(stage.start[0] + [x, 0.0], pose.base_pos[2])
    stage.reset(replace(pose, base_pos=at, joint_pos=joints[0]))
    for target in joints:
        stage.step(Order(target=target))
        assert stage.seen is not None
        if any(("high", paw) in stage.seen.touched for paw in ("FR_foot", "FL_foot")):
            return True
    return False


def test_what_hangs_high_is_touched_sitting_and_cannot_be_standing() -> None:
    steps = 90
    rise = np.clip(np.linspace(0.0, 1.5, steps), 0.0, 1.0)
    zero = np.zeros((steps, 2))
    both, one = np.stack([rise, rise], axis=1), np.stack([rise, 0.0 * rise], axis=1)
    back = np.zeros((steps, 3))
    back[:, 1] = np.radians(-35.0) * rise
    sitting = sit_poses(0.0 * back, both, zero)[2]
    standing = stand_poses(back, 0.0 * rise, one, zero)[2]
    under = greeting.HIGH.pos[0]
    places = np.linspace(under - 0.5, under + 0.1, 7)
    assert any(reaches(NEUTRAL["sit"], sitting, x) for x in places)
    assert not any(reaches(NEUTRAL["stand"], standing, x) for x in places)


@pytest.mark.long
@pytest.mark.parametrize("scene", co.WITH_GOAL)
def test_the_policy_completes_most_scenes(scene: str, tmp_path: Path) -> None:
    options = co.Options(scenes=(scene,), episodes=4, controllers=("policy",))
    whole = co.run_composite(options, cache=tmp_path)["rows"][0]
    assert whole["episodes"] == 4
    assert whole["done"] >= 0.75
