"""The canonical pose (template lengths, no heading, feet on the floor), mirror, calibration."""

import math

import numpy as np
import pytest
from canonical_people import canonical_pose, mirror_pose
from hypothesis import given, settings
from hypothesis import strategies as st

from studio.human.calibration import Calibration, Calibrator, calibrate
from studio.human.canonical import heading_axes
from studio.human.features import FeatureExtractor
from studio.human.pose import HumanPose
from studio.human.posture import body_heading, is_upright
from studio.human.skeleton import (
    BONE_CHILD,
    BONE_LENGTH,
    BONE_PARENT,
    CHAIN,
    INDEX,
    LEG_LENGTH,
    NEUTRAL,
    NEUTRAL_DIRECTION,
)

SEEN_ALL = np.ones(19)


def person(
    direction: np.ndarray = NEUTRAL_DIRECTION, *, heading=0.0, scale=1.0, at=(0.0, 0.0, 0.0), t=0.0
) -> HumanPose:
    """A person of given bone directions, turned, scaled and put somewhere in the source's world."""
    joints = scale * (CHAIN @ (direction * BONE_LENGTH[:, None]))
    return HumanPose(t=t, joint_pos_w=joints @ heading_axes(heading).T + at, confidence=SEEN_ALL)


def random_directions(seed: int) -> np.ndarray:
    d = NEUTRAL_DIRECTION + np.random.default_rng(seed).normal(scale=0.5, size=(18, 3))
    return d / np.linalg.norm(d, axis=1, keepdims=True)


def test_heading_axes_turn_a_person_facing_left_to_face_forward():
    # heading 90 degrees: world +y is the person's forward, world -x their left
    axes = heading_axes(math.pi / 2)
    assert np.array([0.0, 1.0, 0.0]) @ axes == pytest.approx([1.0, 0.0, 0.0])
    assert np.array([-1.0, 0.0, 0.0]) @ axes == pytest.approx([0.0, 1.0, 0.0])


@settings(max_examples=30, deadline=None)
@given(
    st.integers(0, 10**6),
    st.floats(-3.1, 3.1),
    st.floats(0.5, 1.3),
    st.tuples(*[st.floats(-5, 5)] * 3),
)
def test_size_place_and_heading_leave_the_canonical_pose_alone(seed, heading, scale, at):
    directions = random_directions(seed)
    plain = canonical_pose(person(directions), Calibration())
    moved = person(directions, heading=heading, scale=scale, at=at)
    assert canonical_pose(moved, Calibration(heading=heading)) == pytest.approx(plain, abs=1e-9)


def test_every_bone_has_the_template_length_and_the_lower_sole_is_on_the_floor():
    joints = canonical_pose(person(random_directions(1), scale=0.8), Calibration())
    lengths = np.linalg.norm(joints[BONE_CHILD] - joints[BONE_PARENT], axis=1)
    assert lengths == pytest.approx(BONE_LENGTH)
    assert joints[0, :2] == pytest.approx([0.0, 0.0])
    ankles = joints[[INDEX["l_ankle"], INDEX["r_ankle"]], 2]
    assert ankles.min() == pytest.approx(0.08)


def test_neutral_person_is_the_template():
    assert canonical_pose(person(at=(3, 4, 5)), Calibration()) == pytest.approx(NEUTRAL)


def test_pelvis_height_of_bent_knees_by_hand():
    # both thighs 60 degrees forward of straight down, shins vertical: .43 cos 60 + .42 + .08
    d = NEUTRAL_DIRECTION.copy()
    for side in "lr":
        d[INDEX[f"{side}_knee"] - 1] = [math.sin(math.pi / 3), 0.0, -math.cos(math.pi / 3)]
    joints = FeatureExtractor(Calibration()).push(person(d)).joints
    assert joints[0, 2] == pytest.approx(0.215 + 0.42 + 0.08)


def test_unseen_arm_takes_the_neutral_direction():
    pose = person(random_directions(2))
    confidence = SEEN_ALL.copy()
    confidence[INDEX["l_wrist"]] = 0.0
    pose = HumanPose(t=0.0, joint_pos_w=pose.joint_pos_w, confidence=confidence)
    joints = canonical_pose(pose, Calibration())
    forearm = joints[INDEX["l_wrist"]] - joints[INDEX["l_elbow"]]
    assert forearm / 0.25 == pytest.approx(NEUTRAL_DIRECTION[INDEX["l_wrist"] - 1])


@settings(max_examples=30, deadline=None)
@given(st.integers(0, 10**6), st.floats(-3.1, 3.1))
def test_mirror_twice_is_the_identity_and_agrees_with_the_mirrored_calibration(seed, heading):
    pose = person(random_directions(seed), heading=heading)
    twice = mirror_pose(mirror_pose(pose))
    assert (twice.joint_pos_w == pose.joint_pos_w).all()
    calibration = Calibration(heading=heading)
    seen_in_mirror = canonical_pose(mirror_pose(pose), calibration.mirrored())
    assert canonical_pose(pose, calibration, mirror=True) == pytest.approx(seen_in_mirror, abs=1e-9)
    assert calibration.mirrored().mirrored().heading == heading


def test_mirror_puts_the_raised_left_arm_on_the_right():
    d = NEUTRAL_DIRECTION.copy()
    d[INDEX["l_elbow"] - 1] = d[INDEX["l_wrist"] - 1] = [0.0, 0.0, 1.0]
    joints = canonical_pose(person(d), Calibration(), mirror=True)
    assert joints[INDEX["r_wrist"], 2] > 1.8
    assert joints[INDEX["l_wrist"], 2] < 1.0


@pytest.mark.parametrize("heading", [-3.0, -1.2, 0.0, 0.4, 2.9])
def test_body_heading_is_the_way_a_person_faces(heading):
    pose = person(heading=heading)
    angle, weight = body_heading(pose.joint_pos_w, pose.confidence)
    assert angle == pytest.approx(heading)
    assert weight > 0.4


def test_calibrate_finds_size_and_heading_in_spite_of_outliers():
    rng = np.random.default_rng(0)
    poses = []
    for k in range(100):
        pose = person(heading=3.0 + 0.1 * rng.normal(), scale=0.9, at=(1, 2, 0), t=k / 30)
        if k % 5 == 0:  # a fifth is rubbish
            pose = HumanPose(t=pose.t, joint_pos_w=rng.normal(size=(19, 3)), confidence=SEEN_ALL)
        poses.append(pose)
    calibration = calibrate(poses)
    assert calibration.leg_length == pytest.approx(0.9 * LEG_LENGTH, rel=0.03)
    assert calibration.scale == pytest.approx(0.9, rel=0.03)
    assert calibration.bone_length == pytest.approx(0.9 * BONE_LENGTH, rel=0.05)
    assert abs(np.angle(np.exp(1j * (calibration.heading - 3.0)))) < 0.06


def test_calibrate_of_nobody_is_the_template():
    nobody = HumanPose(t=0.0, joint_pos_w=np.zeros((19, 3)), confidence=np.zeros(19))
    for poses in ([], [nobody]):
        calibration = calibrate(poses)
        assert calibration.heading == 0.0
        assert (calibration.bone_length == BONE_LENGTH).all()
        assert calibration.seconds == 0.0


def test_a_live_person_is_taken_up_within_a_second_without_a_jump():
    calibrator = Calibrator()
    headings = [calibrator.heading]
    for k in range(60):
        calibrator.push(person(heading=0.6, scale=1.15, t=k / 30))
        headings.append(calibrator.heading)
    steps = np.diff(headings)
    assert steps.max() < 0.6 * 0.14  # 1/30 s over a time constant of .25 s
    assert steps.min() >= 0.0
    assert headings[30] == pytest.approx(0.6, abs=0.06)
    assert calibrator.calibration.leg_length == pytest.approx(1.15 * LEG_LENGTH, rel=0.02)


def twisted(angle: float) -> np.ndarray:
    """The shoulders turned by `angle` over hips and feet that stay."""
    d = NEUTRAL_DIRECTION.copy()
    turn = heading_axes(angle).T
    for bone in ("l_shoulder", "r_shoulder"):
        d[INDEX[bone] - 1] = d[INDEX[bone] - 1] @ turn
    return d


def test_a_held_twist_is_not_taken_for_a_new_heading():
    calibrator = Calibrator(Calibration(seconds=30.0))
    for k in range(150):
        calibrator.push(person(twisted(1.2), t=k / 30))
    assert abs(calibrator.heading) < math.radians(5)


def test_a_turn_on_the_spot_is_followed_within_seconds():
    calibrator = Calibrator(Calibration(seconds=30.0))
    for k in range(90):
        calibrator.push(person(heading=2.0, t=k / 30))
    assert calibrator.heading == pytest.approx(2.0, abs=math.radians(12))


def test_quiet_upright_standing_refines_the_heading_sooner_than_motion_does():
    rng = np.random.default_rng(0)
    after = {}
    for name, shake in (("quiet", 0.005), ("moving", 0.08)):
        calibrator = Calibrator(Calibration(seconds=30.0))
        for k in range(120):
            pose = person(heading=0.3, t=k / 30)
            moved = pose.joint_pos_w + [shake * math.sin(k), 0, 0] + rng.normal(scale=0.002)
            calibrator.push(HumanPose(t=pose.t, joint_pos_w=moved, confidence=SEEN_ALL))
        after[name] = calibrator.heading
    assert after["quiet"] > 0.24
    assert after["moving"] < 0.10


def test_the_button_makes_the_way_one_faces_straight_ahead_without_a_jump():
    calibrator = Calibrator(Calibration(seconds=30.0))
    calibrator.neutral_now()  # nobody seen yet: nothing happens
    for k in range(30):
        calibrator.push(person(twisted(0.8), heading=0.5, t=k / 30))
    before = calibrator.heading
    calibrator.neutral_now()
    calibrator.push(person(heading=0.5))
    assert abs(calibrator.heading - before) < 0.2
    for _ in range(30):
        calibrator.push(person(heading=0.5))
    angle, _ = body_heading(person(twisted(0.8), heading=0.5).joint_pos_w, SEEN_ALL)
    assert calibrator.heading == pytest.approx(angle, abs=0.02)


def test_reset_goes_back_to_the_start():
    calibrator = Calibrator(Calibration(heading=0.1))
    calibrator.push(person(heading=1.0))
    assert calibrator.heading != 0.1
    calibrator.reset()
    assert calibrator.heading == 0.1
    assert (calibrator.bone_length == BONE_LENGTH).all()


def test_upright_is_upright_and_a_squat_a_bow_or_a_twist_is_not():
    assert is_upright(person(heading=1.0))
    bow = NEUTRAL_DIRECTION.copy()
    for bone in ("spine", "chest"):
        bow[INDEX[bone] - 1] = [math.sin(0.4), 0.0, math.cos(0.4)]
    squat = NEUTRAL_DIRECTION.copy()
    for side in "lr":
        squat[INDEX[f"{side}_knee"] - 1] = [0.8, 0.0, -0.6]
    for pose in (person(bow), person(squat), person(twisted(0.6))):
        assert not is_upright(pose)
