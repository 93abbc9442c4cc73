"""How high the captions hang over the figures of the 3-D view."""

from dataclasses import replace

import numpy as np
import pytest

from studio.human.pose import HumanPose
from studio.puppeteer import Puppeteer
from studio.synthetic.operator import OperatorSource
from studio.web.follow import Above
from studio.web.guarded_viser import GuardedViser
from studio.web.scene import StudioScene

DT = 1.0 / 30.0


def test_a_caption_keeps_its_height_until_the_figure_reaches_into_it():
    above = Above(0.5, 0.1, time_constant=0.3)
    assert [above.push(top, DT) for top in (0.1, 0.4, 0.2)] == [0.5, 0.5, 0.5]
    rising = [above.push(0.8, DT) for _ in range(90)]
    assert np.all(np.diff(rising) > 0.0)
    assert rising[8] == pytest.approx(0.5 + 0.4 * (1.0 - np.exp(-1.0)))  # one time constant
    assert rising[-1] == pytest.approx(0.9, abs=1e-3)
    assert above.push(0.0, 100.0) == pytest.approx(0.5)


def test_a_caption_comes_down_with_a_figure_but_not_with_each_of_its_steps():
    above = Above(0.4, 0.1, first=1.1, slack=0.05)
    assert {above.push(top, DT) for top in (1.0, 0.97, 1.0, 0.96)} == {1.1}
    sinking = [above.push(0.6, DT) for _ in range(90)]
    assert np.all(np.diff(sinking) < 0.0)
    assert sinking[-1] == pytest.approx(0.7, abs=1e-3)
    assert above.push(0.0, 100.0) == pytest.approx(0.4)


def test_the_person_s_caption_follows_the_head_into_a_squat_and_stays_while_nobody_is_seen():
    inner = GuardedViser()
    try:
        scene = StudioScene(inner.server)
        caption = inner.server.scene._handle_from_node_name["/human/caption"]
        person = OperatorSource("quiet", seed=1).read(0.0)
        assert person is not None
        tick = Puppeteer().step(person)

        def height(human: HumanPose | None) -> float:
            for _ in range(90):
                scene.update(replace(tick, human=human), DT)
            return caption.position[2]

        assert height(None) == pytest.approx(1.06, abs=0.02)
        standing = height(person)
        low = person.joint_pos_w * (1.0, 1.0, 0.6)
        squatting = height(replace(person, joint_pos_w=low))
        assert squatting < standing - 0.25
        assert height(None) == pytest.approx(squatting, abs=0.02)
        assert height(person) == pytest.approx(standing, abs=0.02)
    finally:
        inner.stop()
