"""A line that delays, jitters and loses; and the flow over it, on simulated time."""

import numpy as np
import pytest

from studio.control.controllers import PdPlayback
from studio.control.drive_command import PuppeteerConfig
from studio.human.calibration import calibrate
from studio.link.link import Level
from studio.link.robot_policy import RobotPolicy
from studio.link.simulated import Channel, Line, SimulatedLink
from studio.puppeteer import Puppeteer
from studio.robot.a1 import CONTROL_DT
from studio.scenes.stage import Stage
from studio.synthetic.operator import OperatorSource


def through(line: Line, count=2000, seed=0):
    """For each datagram, a ms apart: when it arrived, None for never; and the order of arrival."""
    channel = Channel(line, np.random.default_rng(seed))
    when: dict[int, float] = {}
    for ms in range(count + 2000):
        if ms < count:
            channel.send(ms.to_bytes(4, "little"), 1e-3 * ms)
        for datagram in channel.arrived(1e-3 * ms):
            when[int.from_bytes(datagram, "little")] = 1e-3 * ms
    return when


def test_a_perfect_line_is_there_at_once_and_in_order():
    when = through(Line())
    assert list(when) == list(range(2000))
    assert all(at == pytest.approx(1e-3 * k) for k, at in when.items())


def test_delay_and_jitter_are_between_their_ends_and_some_overtake():
    when = through(Line(delay=0.1, jitter=0.05))
    took = np.array([when[k] - 1e-3 * k for k in range(2000)])
    assert took.min() >= 0.1 - 1e-9
    assert took.max() <= 0.151 + 1e-9
    assert took.mean() == pytest.approx(0.1255, abs=0.002)  # and half a ms of the clock's grain
    assert list(when) != sorted(when)


def test_loss_is_the_share_that_never_arrives_and_the_seed_says_which():
    when = through(Line(loss=0.1))
    # 200 of 2000, standard deviation sqrt(2000 * 0.1 * 0.9) = 13.
    assert len(when) == pytest.approx(1800, abs=45)
    assert through(Line(loss=0.1)) == when
    assert through(Line(loss=0.1), seed=1) != when


def drive(task: str, seconds: float, line: Line, level: Level, seed=3):
    """The flow over the line; the link, and each period's robot's height and phase."""
    source = OperatorSource(task, seed=seed)
    link = SimulatedLink(line, level, seed)
    puppeteer = Puppeteer(PuppeteerConfig(), calibrate(source.calibration_poses()), link=link)
    seen = []
    for k in range(round(seconds / CONTROL_DT)):
        tick = puppeteer.step(source.read(k * CONTROL_DT))
        seen.append((link.engine.state().base_pos[2], link.side.phase, tick))
    return link, seen


@pytest.mark.parametrize("level", ["targets", "references"])
def test_over_a_perfect_line_the_robot_does_what_the_simulated_one_does(level: Level):
    source = OperatorSource("crouch", seed=3)
    puppeteer = Puppeteer(PuppeteerConfig(), calibrate(source.calibration_poses()))
    plain = [puppeteer.step(source.read(k * CONTROL_DT)).robot for k in range(240)]
    _, seen = drive("crouch", 8.0, Line(), level)
    height = np.array([h for h, *_ in seen]), np.array([r.base_pos[2] for r in plain])
    assert np.ptp(height[1]) > 0.02
    assert np.abs(height[0] - height[1])[30:].max() < 0.012  # a period late


@pytest.mark.slow
def test_references_walk_over_a_bad_line():
    line = Line(delay=0.3, jitter=0.05, loss=0.1)
    link, seen = drive("walk", 12.0, line, "references")
    assert min(h for h, *_ in seen) > 0.2
    assert seen[-1][2].robot.base_pos[0] != 0.0
    assert link.server.counts["old"] > 0  # some came too late to be of use
    assert {tick.state for *_, tick in seen} >= {"stand", "walk"}


@pytest.mark.slow
def test_a_line_that_is_cut_in_mid_walk_leaves_a_robot_that_stands():
    source = OperatorSource("walk", seed=3)
    link = SimulatedLink(Line(), "references", 3)
    puppeteer = Puppeteer(PuppeteerConfig(), calibrate(source.calibration_poses()), link=link)
    k = 0
    while k < 600:
        tick = puppeteer.step(source.read(k * CONTROL_DT))
        k += 1
        if k > 200 and tick.state == "walk" and np.hypot(*tick.robot.base_lin_vel_w[:2]) > 0.3:
            break
    assert k < 600
    link._send = lambda datagram: None  # type: ignore[method-assign]
    for _ in range(120):
        puppeteer.step(source.read(k * CONTROL_DT))
        k += 1
    robot = link.engine.state()
    assert link.side.phase == "halting"
    assert robot.base_pos[2] > 0.24
    assert robot.foot_contact.all()
    assert np.abs(robot.base_lin_vel_w).max() < 0.05


def test_a_scene_is_judged_by_the_world_however_late_its_news_are():
    link = SimulatedLink(Line(delay=0.3), "references", policy=RobotPolicy(PdPlayback()))
    stage = Stage("push", link=link)
    puppeteer = Puppeteer(PuppeteerConfig(scene="push"), link=SimulatedLink(Line(), "references"))
    assert stage.seen is None
    tick = puppeteer.step()
    assert puppeteer.stage.seen is not None
    assert puppeteer.stage.seen.robot is puppeteer.stage.world.state
    assert tick.target.shape == (12,)
