"""Lag and warp on signals whose truth is known because the test made them."""

import numpy as np
import pytest

from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.robot import a1
from studio.takes.align import alignment, lag

DT = 1.0 / 30.0


def smooth(rng, n, channels=7):
    """Key poses every 1 to 3 s joined smoothly, at rest for the first and the last second."""
    out = np.zeros((n, channels))
    for c in range(channels):
        knots = np.cumsum(rng.uniform(0.8, 2.0, 40)) + 1.0
        knots = knots[knots < n * DT - 1.5]
        values = rng.normal(0, 1, len(knots))
        x = np.concatenate([[0, 1.0], knots, [n * DT - 1.0, n * DT]])
        y = np.concatenate([[0, 0], values, [0, 0]])
        out[:, c] = np.interp(np.arange(n) * DT, x, y)
    kernel = np.hanning(11) / np.hanning(11).sum()
    return np.apply_along_axis(lambda v: np.convolve(v, kernel, "same"), 0, out)


def delayed(x, lag):
    t = np.arange(len(x)) * DT
    return np.stack([np.interp(t - lag, t, x[:, c]) for c in range(x.shape[1])], axis=-1)


def found(human, robot, lifts=((), ())):
    """The lag of signals in the place of poses."""
    left, right = (np.array(t, dtype=float) for t in lifts)
    side = lag.RobotSide(channels=robot, shown=robot, lifts=(left, right))
    return lag.align(lag.HumanSide(channels=human, pose=human), side, DT)


def test_known_lag_is_found_within_one_frame_in_95_percent():
    rng = np.random.default_rng(1)
    errors = []
    for _ in range(100):
        robot = smooth(rng, 300) * [0.2, 0.3, 0.2, 0.03, 0.1, 0.1, 0.0]
        late = rng.uniform(0.0, 0.8)
        gain = rng.uniform(0.6, 1.6, 7) * [1, 1, 1, 2.5, 3, 3, 1]
        human = delayed(robot, late) * gain + rng.normal(0, 0.02, robot.shape)
        errors.append(abs(found(human, robot).lag - late))
    assert np.mean(np.array(errors) <= DT) >= 0.95


def test_nothing_moving_has_no_lag_and_no_certainty():
    none = found(np.zeros((300, 7)), np.zeros((300, 7)))
    assert (none.lag, none.certainty) == (0.0, 0.0)


def test_noise_against_noise_is_not_certain():
    rng = np.random.default_rng(2)
    noise = found(rng.normal(size=(300, 7)), rng.normal(size=(300, 7)))
    assert noise.correlation < 0.3
    assert noise.certainty < 0.5


def test_warp_recovers_a_tempo_that_wanders_and_leaves_a_person_in_time_alone():
    rng = np.random.default_rng(3)
    robot = smooth(rng, 300) * alignment._ROBOT_SCALE * 1.5
    t = np.arange(300) * DT
    truth = 0.2 * np.sin(2 * np.pi * t / 10.0)  # the person reads the robot's time at t + truth(t)
    scaled = robot / alignment._ROBOT_SCALE * alignment._HUMAN_SCALE
    human_t = t + truth
    human = np.stack([np.interp(t, human_t, scaled[:, c]) for c in range(7)], axis=-1)
    warp = alignment.time_warp(human, robot, DT)
    before = np.sqrt(np.mean(truth**2))
    assert np.sqrt(np.mean((warp - truth) ** 2)) < 0.5 * before
    assert np.all(np.diff(t + warp) >= -1e-12)
    assert np.abs(alignment.time_warp(scaled, robot, DT)).max() <= DT


def test_channels_have_the_signs_of_the_vocabulary():
    person = np.zeros((2, NUM_JOINTS, 3))
    at = {
        "pelvis": (0, 0, 0.9), "chest": (0, 0, 1.4), "l_shoulder": (0, 0.2, 1.4),
        "r_shoulder": (0, -0.2, 1.4), "l_wrist": (0, 0.2, 0.8), "r_wrist": (0, -0.2, 0.8),
        "l_hip": (0, 0.1, 0.9), "r_hip": (0, -0.1, 0.9), "l_ankle": (0, 0.1, 0.1),
        "r_ankle": (0, -0.1, 0.1),
    }  # fmt: skip
    for name, p in at.items():
        person[:, INDEX[name]] = p
    # bends forward by atan(0.5 / 0.5) = 45 deg, lifts the left foot by 0.2 m, raises the right arm
    person[1, INDEX["chest"]] = (0.5, 0, 1.4)
    person[1, INDEX["l_ankle"]] = (0, 0.1, 0.3)
    person[1, INDEX["r_wrist"]] = (0, -0.2, 1.6)
    h = dict(
        zip(alignment.CHANNELS, (c := alignment.human_channels(person))[1] - c[0], strict=True)
    )
    assert h["pitch"] == pytest.approx(np.pi / 4)
    assert h["step"] == pytest.approx(0.2)
    assert h["right"] == pytest.approx(0.8)
    assert h["roll"] == pytest.approx(0.0)
    contact = np.array([[1.0, 1, 1, 1], [1, 0, 0, 1]])  # FL and RR in the air: the left foot
    robot = alignment.robot_channels(
        np.tile([0.0, 0, a1.STAND_HEIGHT], (2, 1)),
        np.tile([1.0, 0, 0, 0], (2, 1)),
        np.tile(a1.STAND_JOINT_POS, (2, 1)),
        contact,
    )
    assert robot[:, 6].tolist() == [0.0, 1.0]
    assert robot[0, 3] == pytest.approx(a1.STAND_HEIGHT)
    assert robot[0, 4] == pytest.approx(a1.FOOT_RADIUS, abs=1e-5)
