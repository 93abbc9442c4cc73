"""The rules of style "semantic": hand-computed, and read off somebody who steps."""

import numpy as np
import pytest
from canonical_people import NEUTRAL_Q

from studio import geometry
from studio.human.skeleton import BONES
from studio.reference import gait
from studio.reference.stepping import forward_cadence
from studio.retarget.march import MarchReader, speed_of, trunk_of, turn_of
from studio.retarget.semantic import SemanticWalk
from studio.robot.a1 import CONTROL_DT, JOINT_LOWER, JOINT_UPPER

L_ANKLE = 3 * BONES.index("l_ankle") + 2
R_ANKLE = 3 * BONES.index("r_ankle") + 2


def stepping(cadence, step, seconds, yaw=0.0):
    """q (T, F) of somebody whose feet go up in turn, half a sine of `step` m each."""
    t = np.arange(round(seconds / CONTROL_DT)) * CONTROL_DT
    q = np.repeat(NEUTRAL_Q[None], len(t), axis=0)
    wave = np.sin(2.0 * np.pi * cadence * t)
    q[:, L_ANKLE] += step * np.maximum(wave, 0.0)
    q[:, R_ANKLE] += step * np.maximum(-wave, 0.0)
    upper = [i for i, b in enumerate(BONES) if b.endswith(("shoulder", "elbow", "wrist"))]
    for i in upper:
        at = slice(3 * i, 3 * i + 3)
        q[:, at] = geometry.quat_rotate(geometry.quat_from_rpy([0.0, 0.0, yaw]), q[:, at])
    return q


def test_speed_grows_with_the_root_of_cadence_times_step_height():
    # 1 stride/s, 0.0875 m: sqrt(0.0875 / 0.35) = 0.5 of the fastest walk at that cadence.
    assert speed_of(1.0, 0.0875) == pytest.approx(0.5 * float(gait.speed_limit(1.0)))
    # 0.35 m and more is all that a stride a second can mean; 0.45 m counts as highest.
    assert speed_of(1.0, 0.35) == pytest.approx(float(gait.speed_limit(1.0)))
    assert speed_of(0.5, 0.45) == speed_of(0.5, 0.9)
    assert speed_of(0.0, 0.3) == 0.0


def test_turn_follows_the_trunks_yaw_or_its_lean_beyond_a_dead_zone():
    turn = lambda yaw, lean: np.degrees(turn_of(np.radians(yaw), np.radians(lean)))  # noqa: E731
    assert turn(15.0, 0.0) == pytest.approx(7.0)  # 0.7 (15 - 5)
    assert turn(-15.0, 0.0) == pytest.approx(-7.0)
    assert turn(0.0, 17.0) == pytest.approx(10.0)  # 1.0 (17 - 7)
    assert turn(15.0, -10.0) == pytest.approx(7.0)  # 7 says more than -3
    assert turn(4.0, 6.0) == 0.0
    assert turn(60.0, 0.0) == pytest.approx(15.0)


def test_the_trunk_is_read_as_it_was_turned():
    yaw, lean = trunk_of(stepping(1.0, 0.0, 0.1, yaw=0.3)[0])
    assert yaw == pytest.approx(0.3, abs=0.01)
    assert lean == pytest.approx(0.0, abs=0.01)


@pytest.mark.parametrize(("cadence", "step"), [(0.5, 0.3), (1.0, 0.2), (1.8, 0.08)])
def test_cadence_and_height_of_steps_are_read(cadence, step):
    reader = MarchReader()
    read = [reader.step(q) for q in stepping(cadence, step, 6.0)]
    late = read[len(read) // 2 :]
    assert np.mean([m.cadence for m in late]) == pytest.approx(cadence, rel=0.05)
    assert np.mean([m.step for m in late]) == pytest.approx(step, rel=0.1)


def test_somebody_who_stands_or_fidgets_with_the_feet_means_no_walk():
    reader = MarchReader()
    assert {reader.step(q).speed for q in stepping(1.0, 0.02, 3.0)} == {0.0}


def test_the_robot_chooses_a_pace_at_which_the_speed_is_within_its_steps():
    for speed in np.linspace(0.02, 0.7, 30):
        cadence = forward_cadence(speed)
        assert float(gait.speed_limit(cadence)) >= speed
        assert cadence <= 0.9 or cadence >= 1.4


def test_walking_stops_with_all_feet_down_when_the_person_stops():
    stride = SemanticWalk().begin()
    q = np.concatenate([stepping(1.5, 0.2, 4.0), np.repeat(NEUTRAL_Q[None], 90, axis=0)])
    said = [stride(np.concatenate([row, 0.0 * row, 0.0 * row])) for row in q]
    walked = np.array([m.rates[24] for m in said])  # forward speed, m/s
    assert walked[90:120].mean() > 0.3
    assert np.abs(walked[-30:]).max() < 0.01
    assert all(np.all(m.contact_prob > 0.9) for m in said[-30:])


def test_a_batch_is_mapped_as_its_frames_one_after_another():
    q = stepping(1.2, 0.2, 2.0)
    triplet = np.concatenate([q, 0.0 * q, 0.0 * q], axis=1)
    walk = SemanticWalk()
    stride = walk.begin()
    once = np.stack([stride(row).joint_pos for row in triplet])
    assert np.array_equal(walk(triplet).joint_pos, once)
    assert np.all((once >= JOINT_LOWER) & (once <= JOINT_UPPER))
