"""The flow on one page, as a library: poses in, ticks out, within limits whatever comes in."""

from dataclasses import replace

import numpy as np
import pytest

from studio.control.drive_command import Directive, DriveCommand, PuppeteerConfig
from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.puppeteer import Puppeteer
from studio.reference.intent import StateName
from studio.reference.stances import NEUTRAL
from studio.retarget.retargeter import Retargeter
from studio.retarget.settings import LIMITS
from studio.robot import a1
from studio.synthetic.operator import OperatorSource


def make(task="quiet", seed=0, **config):
    """A puppeteer and the poses of an operator repeating a task."""
    source = OperatorSource(task, seed=seed)
    puppeteer = Puppeteer(PuppeteerConfig(**config), calibrate(source.calibration_poses()))
    poses = (source.read(k / 30.0) for k in range(10_000))
    return puppeteer, (pose for pose in poses if pose is not None)


def run(puppeteer, poses, seconds, **command):
    given = DriveCommand(**command)
    return [puppeteer.step(next(poses), given) for _ in range(round(seconds * 30))]


def test_for_pose_in_source_gives_one_tick_a_pose():
    puppeteer, poses = make()
    ticks = [puppeteer.step(pose) for pose, _ in zip(poses, range(30))]
    assert [tick.index for tick in ticks] == list(range(30))
    assert all(tick.human_fresh for tick in ticks)
    assert ticks[-1].state == "stand"
    assert ticks[-1].controller in ("pd_playback", "policy")


@pytest.mark.parametrize(("task", "state"), [("quiet", "stand"), ("sit_tilt", "sit")])
def test_the_robot_starts_in_the_first_voted_state(task: str, state: StateName):
    puppeteer, poses = make(task)
    first = run(puppeteer, poses, 1.0)
    voted = next(tick for tick in first if tick.expert != "unknown")
    assert voted.state == voted.expert == state
    np.testing.assert_allclose(voted.robot.joint_pos, NEUTRAL[state].joint_pos, atol=np.radians(12))


def test_a_locked_state_is_where_the_robot_starts_and_stays():
    puppeteer, poses = make("walk", state="sit")
    ticks = run(puppeteer, poses, 2.0)
    assert {tick.state for tick in ticks[1:]} == {"sit"}


def test_the_action_passes_the_low_pass_and_the_target_never_leaves_the_limits():
    puppeteer, poses = make(controller="pd_playback")
    rng = np.random.default_rng(0)
    wild = lambda *_: rng.uniform(-9.0, 9.0, 12)  # noqa: E731
    puppeteer.controller.act = wild  # type: ignore[method-assign]
    for tick in run(puppeteer, poses, 1.0):
        assert (tick.target >= a1.JOINT_LOWER).all()
        assert (tick.target <= a1.JOINT_UPPER).all()
        assert np.abs(tick.action).max() > 1.0


def test_stand_still_holds_the_neutral_pose_while_the_reference_moves():
    puppeteer, poses = make("crouch", controller="stand_still")
    ticks = run(puppeteer, poses, 4.0)
    np.testing.assert_allclose(ticks[-1].action, NEUTRAL["stand"].joint_pos, atol=1e-6)
    reference = np.array([tick.reference.joint_pos for tick in ticks])
    assert np.ptp(reference, axis=0).max() > 0.05


def test_pd_playback_sends_the_references_joints():
    puppeteer, poses = make("crouch", controller="pd_playback")
    for tick in run(puppeteer, poses, 1.0):
        np.testing.assert_array_equal(tick.action, tick.reference.joint_pos)


def test_a_missing_pose_is_replaced_by_the_last_one():
    puppeteer, poses = make()
    run(puppeteer, poses, 1.0)
    tick = puppeteer.step(None)
    assert not tick.human_fresh
    assert tick.human is not None
    assert tick.why == ""
    assert [puppeteer.step(None) for _ in range(14)][-1].why.startswith("stale")


def test_without_any_person_the_robot_stands_and_says_so():
    puppeteer = Puppeteer(PuppeteerConfig())
    ticks = [puppeteer.step() for _ in range(45)]
    assert {tick.state for tick in ticks} == {"stand"}
    assert ticks[-1].why.startswith("nobody seen")
    assert not ticks[-1].fallen


def test_bad_poses_are_refused_and_counted():
    puppeteer, poses = make()
    run(puppeteer, poses, 0.5)
    good = next(poses)
    nan = good.joint_pos_w.copy()
    nan[4, 2] = np.nan
    for bad in (
        replace(good, joint_pos_w=nan),
        replace(good, joint_pos_w=good.joint_pos_w * 1000.0),
        replace(good, joint_pos_w=good.joint_pos_w + 40.0),
        replace(good, t=-5.0),
        object(),
    ):
        tick = puppeteer.step(bad)  # type: ignore[arg-type]
        assert not tick.human_fresh
        assert np.isfinite(tick.target).all()
    assert puppeteer.counters["rejected"] == 5
    assert puppeteer.step(good).human_fresh


def test_the_same_seed_gives_the_same_ticks():
    ticks = []
    for _ in range(2):
        puppeteer, poses = make("walk", seed=3)
        ticks.append(run(puppeteer, poses, 2.0)[-1])
    np.testing.assert_array_equal(ticks[0].robot.joint_pos, ticks[1].robot.joint_pos)
    np.testing.assert_array_equal(ticks[0].reference.base_pos, ticks[1].reference.base_pos)


def test_reset_makes_it_as_new():
    puppeteer, poses = make("walk", seed=3)
    first = run(puppeteer, poses, 1.0)[-1]
    puppeteer.reset()
    again = run(puppeteer, make("walk", seed=3)[1], 1.0)[-1]
    np.testing.assert_allclose(again.robot.joint_pos, first.robot.joint_pos, atol=1e-9)
    assert again.index == first.index


def test_standing_up_takes_under_three_seconds_from_lying_damped():
    puppeteer, poses = make()
    run(puppeteer, poses, 0.5)
    down = run(puppeteer, poses, 1.5, damping=True, directive=Directive.STAND)
    assert down[-1].robot.base_pos[2] < 0.2
    puppeteer.stand_up()
    up = run(puppeteer, poses, 3.0, directive=Directive.STAND)
    assert up[-1].robot.base_pos[2] > 0.24
    assert not up[-1].fallen


def test_sliders_take_what_is_in_range_and_say_what_would_be():
    puppeteer, _ = make()
    for name, (low, high) in LIMITS.items():
        puppeteer.set_gain(name, high)
        assert getattr(puppeteer.retargeter.settings, name) == high
        with pytest.raises(StudioError, match="between"):
            puppeteer.set_gain(name, low - 1.0)
        with pytest.raises(StudioError, match="between"):
            puppeteer.set_gain(name, float("nan"))
    with pytest.raises(StudioError, match="tilt_gain"):
        puppeteer.set_gain("cheer", 1.0)


def test_unknown_names_are_answered_with_the_known_ones():
    with pytest.raises(StudioError, match="march"):
        Puppeteer(PuppeteerConfig(style="moonwalk"))
    with pytest.raises(StudioError, match="pd_playback"):
        Puppeteer(PuppeteerConfig(controller="magic"))
    with pytest.raises(StudioError, match="stand"):
        Puppeteer(PuppeteerConfig(state="fly"))


def test_a_robot_that_lies_on_its_trunk_has_fallen_and_stays_fallen():
    puppeteer, poses = make()
    assert not run(puppeteer, poses, 0.2)[-1].fallen
    puppeteer.stage.world.push(np.array([0.0, 4.0, 0.0]))
    assert run(puppeteer, poses, 1.5)[-1].fallen


def test_every_section_of_a_period_is_timed():
    puppeteer, poses = make("walk")
    timed = run(puppeteer, poses, 0.5)[-1].timings_ms  # `bench` has this machine's figures
    sections = {"features", "selector", "mapper", "controller", "policy", "physics"}
    assert sections | {"inference"} <= set(timed)
    assert all(value >= 0.0 for value in timed.values())


def test_a_shared_retargeter_can_be_given():
    retargeter = Retargeter.load("march")
    assert Puppeteer(PuppeteerConfig(), retargeter=retargeter).retargeter is retargeter


def test_whose_steps_it_walks_in_can_change_in_mid_walk():
    """The generator's are even: the walk goes on, at once in those."""
    puppeteer, poses = make("walk", seed=3)
    run(puppeteer, poses, 8.0)

    def unevenness(ticks):
        speeds = [np.hypot(*tick.reference.base_lin_vel_w[:2]) for tick in ticks]
        return np.std(speeds) / np.mean(speeds)

    mapped = run(puppeteer, poses, 4.0)
    puppeteer.set_walk(steps="generated")
    even = run(puppeteer, poses, 6.0)[60:]
    assert puppeteer.config.travel == "auto"
    assert {tick.state for tick in mapped + even} == {"walk"}
    assert unevenness(even) < 0.5 * unevenness(mapped)
