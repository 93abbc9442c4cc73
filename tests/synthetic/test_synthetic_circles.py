"""The person who walks by circling the hands: round circles, standing feet, easing into it."""

import numpy as np

from studio.human.skeleton import INDEX
from studio.reference.marching import Bout, march_track
from studio.synthetic import Person, play
from studio.synthetic import signals as sig
from studio.synthetic.operator import OperatorSource


def circling(lift, seed=0):
    """True joints (T, 19, 3) of ten circles at one a second."""
    track = march_track("walk", 10.0, [Bout(half_strides=20, cadence=1.0, lift=lift)])
    person = Person.sample(np.random.default_rng(seed), sensor="mocap", style="circles").still()
    return play(sig.of_track(track), person, seed, "circles").true_pos_w


def hand(joints, side):
    """(T, 2) forward and up, of a wrist from its shoulder, in the midst of the circling."""
    at = joints[:, INDEX[f"{side}_wrist"]] - joints[:, INDEX[f"{side}_shoulder"]]
    return at[120:240, [0, 2]]


def test_hands_go_round_forwards_over_the_top_in_turn_while_the_feet_stand():
    joints = circling(0.8)
    for side in "lr":
        way = hand(joints, side) - hand(joints, side).mean(axis=0)
        turned = np.diff(np.unwrap(np.arctan2(way[:, 1], way[:, 0])))
        # Four seconds at one circle a second, clockwise seen from the left: forwards at the top.
        assert -turned.sum() / (2.0 * np.pi) > 3.5
        assert np.mean(turned < 0.0) > 0.9
        ankle = joints[:, INDEX[f"{side}_ankle"]]
        assert np.ptp(ankle, axis=0).max() < 1e-6
    left, right = hand(joints, "l")[:, 1], hand(joints, "r")[:, 1]
    assert np.corrcoef(left, right)[0, 1] < -0.7


def test_a_higher_step_is_meant_by_a_larger_circle():
    small, large = (np.ptp(hand(circling(lift), "r"), axis=0).min() for lift in (0.2, 1.0))
    assert large > 1.5 * small
    assert small > 0.05


def test_an_operator_eases_from_one_style_into_the_other_and_back():
    operator = OperatorSource("walk", seed=3)
    poses = []
    for k in range(360):
        if k in (100, 130, 250):
            operator.set_style("circles" if k == 100 else "march" if k == 250 else "semantic")
        poses.append(operator.read(k / 30.0))
    assert all(pose is not None for pose in poses)
    assert [round(pose.t * 30.0) for pose in poses] == list(range(360))
    joints = np.array([pose.joint_pos_w for pose in poses])
    assert np.linalg.norm(np.diff(joints, axis=0), axis=-1).max() < 0.25
