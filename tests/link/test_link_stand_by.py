"""References that end in the middle of anything come to a stand without a jump."""

import numpy as np
import pytest

from studio.control.drive_command import PuppeteerConfig
from studio.control.footing import feet_w
from studio.control.stand_by import StandBy
from studio.human.calibration import calibrate
from studio.puppeteer import Puppeteer
from studio.reference.stances import NEUTRAL
from studio.synthetic.operator import OperatorSource


def driven(task, seconds):
    """Each period's reference, expert, and whether on a way between two states."""
    source = OperatorSource(task, seed=4)
    config = PuppeteerConfig(controller="pd_playback")
    puppeteer = Puppeteer(config, calibrate(source.calibration_poses()))
    said = []
    for k in range(round(seconds * 30)):
        tick = puppeteer.step(source.read(k / 30.0))
        expert = puppeteer.state_machine._report(puppeteer.state_machine.state).expert
        said.append((tick.reference, expert, tick.state == "transition"))
    return said


@pytest.fixture(scope="module", params=["walk", "sit_tilt", "crouch"])
def said(request):
    return driven(request.param, 8.0)


def test_it_ends_in_neutral_standing_within_seconds_whenever_the_line_breaks(said):
    for cut in range(10, len(said), 17):
        machine = StandBy()
        for reference, expert, moving in said[:cut]:
            machine.see(reference, expert, moving)
        last, count = machine.reference, 0
        while not machine.stands and count < 200:
            decision = machine.come_to_stand()
            jump = np.abs(decision.reference.joint_pos - last.joint_pos).max()
            assert jump < 1.0, (cut, count)  # limits, which come last, allow 0.7 rad of it
            assert np.linalg.norm(decision.reference.base_pos - last.base_pos) < 0.06
            last, count = decision.reference, count + 1
        assert machine.stands, cut
        np.testing.assert_allclose(last.joint_pos, NEUTRAL["stand"].joint_pos, atol=0.08)
        assert np.ptp(feet_w(last)[:, 2]) < 0.01


def test_who_stands_goes_on_standing():
    machine = StandBy()
    for _ in range(10):
        assert machine.come_to_stand().state == "stand"
    assert machine.stands
