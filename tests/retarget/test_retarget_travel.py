"""Somebody who crosses the room: the reference goes beside them, whichever way they go."""

import math
from dataclasses import replace

import numpy as np
import pytest

from studio import geometry
from studio.human.calibration import calibrate
from studio.reference.check import check
from studio.reference.realize import realize
from studio.reference.tasks_travel import MAX_SPIN, TRAVEL
from studio.retarget.retargeter import Retargeter
from studio.robot import a1
from studio.synthetic.operator import OperatorSource

SIZE = math.sqrt(a1.STAND_HEIGHT / 0.85)
"""Froude's ratio for a leg of 0.85 m."""


def crossing(velocity, turn=0.0, seconds=8.0, task="walk", seed=4, stand=1.0):
    """Poses of a marcher carried along at `velocity` (m/s, forward and left of them) and `turn`."""
    source = OperatorSource(task, seed=seed)
    place, yaw, out = np.zeros(2), 0.0, []
    for k in range(round(seconds * 30)):
        pose = source.read(k / 30.0)
        if pose is None:
            continue
        if k / 30.0 > stand:
            yaw += turn / 30.0
            c, s = math.cos(yaw), math.sin(yaw)
            place = place + np.array([[c, -s], [s, c]]) @ velocity / 30.0
        joints = geometry.quat_rotate(geometry.quat_from_rpy([0.0, 0.0, yaw]), pose.joint_pos_w)
        joints[:, :2] += place
        out.append(replace(pose, joint_pos_w=joints))
    return out, source


def followed(velocity, turn=0.0, **settings):
    """Way (2,) m and turn (rad) of the reference over the last 4 s, in the frame they began in."""
    poses, source = crossing(np.array(velocity), turn)
    retargeter = Retargeter.load("march", calibrate(source.calibration_poses()), **settings)
    retargeter.set_expert("walk")
    told = [retargeter.step(pose).reference for pose in poses]
    last = told[-121:]
    yaw = np.unwrap([float(geometry.heading(pose.base_quat)) for pose in last])
    way = last[-1].base_pos[:2] - last[0].base_pos[:2]
    c, s = math.cos(-yaw[0]), math.sin(-yaw[0])
    return np.array([[c, -s], [s, c]]) @ way, yaw[-1] - yaw[0], retargeter


@pytest.mark.parametrize("velocity", [(1.0, 0.0), (-0.6, 0.0), (0.0, 0.45), (0.0, -0.45)])
def test_the_robot_goes_where_the_person_goes_at_its_own_size(velocity):
    way, turned, retargeter = followed(velocity)
    size = math.sqrt(a1.STAND_HEIGHT / retargeter.extractor.calibration.leg_length)
    assert np.allclose(way / 4.0, size * np.array(velocity), atol=0.05)
    assert abs(turned) < math.radians(8.0)


@pytest.mark.parametrize("turn", [-0.5, 0.5])
def test_it_turns_as_they_turn(turn):
    _, turned, _ = followed((0.7, 0.0), turn)
    assert turned / 4.0 == pytest.approx(turn, abs=0.06)


def test_a_march_in_place_and_travel_switched_off_are_read_as_ever():
    still = followed((0.0, 0.0))
    assert not still[2].path.found
    off = followed((-0.6, 0.0), travel="off")
    assert off[0][0] > -0.05  # who walks backward marches on, as before


def test_who_stops_is_stood_beside_and_a_mirror_swaps_the_sides():
    way, _, retargeter = followed((0.0, 0.45), mirror=True)
    assert way[1] < -0.2
    assert retargeter.travels
    for _ in range(40):
        retargeter.step(None)
    assert not retargeter.travels


def test_motions_through_space_reach_their_range_and_break_no_limit():
    fastest = np.zeros(3)
    for seed in range(24):
        track = TRAVEL.sample(np.random.default_rng(seed), 10.0, 1.0)
        assert check(realize(track)) == []
        asked = np.stack([track.speed, track.side, track.turn], axis=1)
        fastest = np.maximum(fastest, np.abs(asked).max(axis=0))
    assert np.all(fastest > [0.85, 0.25, 0.85 * MAX_SPIN])
