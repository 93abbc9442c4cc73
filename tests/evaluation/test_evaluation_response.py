"""How late a stage is, on signals whose lag is known, and through the whole flow."""

import numpy as np
import pytest

from studio.control.drive_command import PuppeteerConfig
from studio.errors import StudioError
from studio.evaluation import response
from studio.evaluation.lateness import lag_s, onset_s
from studio.evaluation.response_signals import (
    GESTURES,
    STAGES,
    of_person,
    of_robot,
    track_of,
)
from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.puppeteer import Puppeteer
from studio.reference.stances import NEUTRAL
from studio.retarget.settings import joint_speed
from studio.robot.a1 import CONTROL_DT, STAND_JOINT_POS
from studio.synthetic.operator import OperatorSource


def movements(late: float = 0.0, size: float = 1.0) -> np.ndarray:
    """Three smooth movements of 0.4 s there and back, `late` s after their time."""
    t = np.arange(450) * CONTROL_DT - late
    begins = 2.5 + 4.3 * np.arange(3)
    return size * np.exp(-(((t[:, None] - begins - 0.9) / 0.4) ** 2)).sum(axis=1)


@pytest.mark.parametrize("late", [0.0, 0.05, 0.21, 0.6])
def test_a_signal_that_comes_later_is_as_late_as_it_comes(late):
    person = movements()
    found = lag_s(person, 0.3 - movements(late, size=-7.0))
    assert found == pytest.approx(late, abs=0.005)  # whatever its size and its rest
    begins = onset_s(person, 2.5)
    other = onset_s(movements(late, size=4.0), 2.5)
    assert begins is not None
    assert other is not None
    assert other - begins == pytest.approx(late, abs=0.005)


def test_who_does_something_else_has_no_lag_and_who_does_nothing_no_onset():
    person = movements()
    noise = np.random.default_rng(0).standard_normal(len(person))
    assert lag_s(person, noise) is None
    assert lag_s(person, np.zeros(len(person))) is None
    assert onset_s(np.zeros(len(person)), 2.5) is None


def test_hands_and_trunks_are_read_whichever_way_a_person_faces():
    still = np.zeros((NUM_JOINTS, 3))
    for name, place in {
        "pelvis": (0.0, 0.0, 0.9), "neck": (0.0, 0.0, 1.4), "l_hip": (0.0, 0.1, 0.9),
        "r_hip": (0.0, -0.1, 0.9), "l_shoulder": (0.0, 0.2, 1.35),
        "r_shoulder": (0.0, -0.2, 1.35), "r_wrist": (0.0, -0.25, 0.8),
    }.items():  # fmt: skip
        still[INDEX[name]] = place
    lean, bend, twist, hand = (still.copy() for _ in range(4))
    lean[INDEX["neck"]] += [0.0, -0.2, 0.0]
    bend[INDEX["neck"]] += [0.2, 0.0, 0.0]
    twist[INDEX["r_shoulder"]] += [0.1, 0.0, 0.0]
    hand[INDEX["r_wrist"]] += [0.0, 0.0, 0.6]
    for yaw in (0.0, 1.0, 3.0):
        turn = np.array(
            [[np.cos(yaw), -np.sin(yaw), 0.0], [np.sin(yaw), np.cos(yaw), 0.0], [0.0, 0.0, 1.0]]
        )
        for name, body in (("lean", lean), ("bend", bend), ("twist", twist), ("raised hand", hand)):
            moved = of_person(name, body @ turn.T) - of_person(name, still @ turn.T)
            assert moved > 0.2, (name, yaw)


def test_a_robot_s_signals_grow_as_a_person_s_do():
    neutral = NEUTRAL["stand"]
    up = STAND_JOINT_POS.copy()
    up[1:3] = [0.2, -2.4]  # the front right leg drawn up
    for name in ("raised hand", "first step"):
        assert of_robot(name, up, neutral.base_quat) > of_robot(
            name, STAND_JOINT_POS, neutral.base_quat
        )
    half = np.sin(0.1)
    for axis, name in enumerate(("lean", "bend", "twist")):
        quat = np.array([np.cos(0.1), 0.0, 0.0, 0.0])
        quat[1 + axis] = half
        assert of_robot(name, STAND_JOINT_POS, quat) == pytest.approx(0.2)


def test_every_movement_begins_when_its_track_says():
    for name in GESTURES:
        track, begins = track_of(name)
        assert len(begins) == 3
        k = round(begins[0] / CONTROL_DT)
        parts = [track.tilt, track.reach, track.crouch[:, None], track.cadence[:, None]]
        moved = np.abs(np.concatenate(parts, axis=1)).sum(axis=1)
        assert not moved[: k - 1].any()
        assert moved[k + 6] > 0.0


def test_joints_that_may_be_quicker_are_less_late_and_never_quicker_than_that():
    late, fastest = [], []
    for degrees in (120.0, 240.0):
        each = response._acted("raised hand", 0, PuppeteerConfig(joint_speed=joint_speed(degrees)))
        late.append(lag_s(each.signals["person"], each.signals["reference"]))
        puppeteer = Puppeteer(PuppeteerConfig(joint_speed=joint_speed(degrees)))
        source = OperatorSource("manipulate_right", seed=3)
        ticks = [puppeteer.step(source.read(k * CONTROL_DT)) for k in range(360)]
        joints = np.array([tick.reference.joint_pos for tick in ticks if tick.state == "stand"])
        fastest.append(np.degrees(np.abs(np.diff(joints, axis=0)).max()) / CONTROL_DT)
        assert not ticks[-1].fallen
    assert late[1] < late[0] - 0.05
    assert 110.0 < fastest[0] <= 120.0 + 1e-6
    assert 120.0 < fastest[1] <= 240.0 + 1e-6


def test_a_joint_speed_that_no_motor_reaches_is_refused():
    with pytest.raises(StudioError, match="60 and 480 degrees a second, not 481"):
        joint_speed(481.0)


def test_a_raised_hand_reaches_each_stage_after_the_one_before_and_the_limit_cuts_it():
    each = response._acted("raised hand", 0, PuppeteerConfig())
    found = [lag_s(each.signals["person"], each.signals[stage]) for stage in STAGES]
    lags = [lag for lag in found if lag is not None]
    assert len(lags) == len(STAGES)
    assert lags[0] == pytest.approx(0.0, abs=1e-9)
    assert max(lags[1:3]) < lags[3] < lags[4]
    assert each.clipped > 0.3
    assert not each.fell
