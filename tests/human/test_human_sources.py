"""Every source skeleton maps onto the canonical joints the right way up and the right way round."""

import json

import numpy as np
import pytest

from studio.errors import StudioError
from studio.human.joint_names import bvh_skeleton
from studio.human.sensor_skeletons import SKELETONS, SourceSkeleton, skeleton
from studio.human.skeleton import (
    BONE_LENGTH,
    CHAIN,
    INDEX,
    JOINTS,
    LEG_LENGTH,
    MIRROR,
    NEUTRAL,
    NEUTRAL_DIRECTION,
    PARENTS,
)


def source_frame(source: SourceSkeleton, canonical: np.ndarray) -> np.ndarray:
    """Joints in the source's own axes that map to `canonical` (least squares; others follow)."""
    return np.linalg.pinv(source.weights) @ canonical @ source.axes


def test_neutral_template_stands_on_the_floor_with_the_lengths_of_the_findings():
    assert NEUTRAL[INDEX["pelvis"]] == pytest.approx([0.0, 0.0, 0.43 + 0.42 + 0.08])
    assert pytest.approx(0.85) == LEG_LENGTH
    for bone, length in {"knee": 0.43, "ankle": 0.42, "elbow": 0.29, "wrist": 0.25}.items():
        for side in "lr":
            assert BONE_LENGTH[INDEX[f"{side}_{bone}"] - 1] == length
    toes = NEUTRAL[[INDEX["l_toe"], INDEX["r_toe"]]]
    assert (toes[:, 0] > 0.1).all()
    assert np.abs(toes[:, 2]).max() < 0.03  # sole level: the toe joint is near the floor


def test_parents_come_before_children_and_the_chain_adds_bones_up_to_the_pelvis():
    assert all(parent < joint for joint, parent in enumerate(PARENTS))
    # l_wrist hangs on spine, chest, l_shoulder, l_elbow, l_wrist: five bones
    assert CHAIN[INDEX["l_wrist"]].sum() == 5
    assert not CHAIN[0].any()


def test_mirror_permutes_left_and_right_and_keeps_the_trunk():
    assert [MIRROR[MIRROR[i]] for i in range(19)] == list(range(19))
    assert JOINTS[MIRROR[INDEX["l_toe"]]] == "r_toe"
    assert MIRROR[INDEX["neck"]] == INDEX["neck"]
    mirrored = NEUTRAL_DIRECTION[np.array(MIRROR[1:]) - 1] * (1, -1, 1)
    assert mirrored == pytest.approx(NEUTRAL_DIRECTION)


@pytest.mark.parametrize("name", sorted(SKELETONS))
def test_axes_are_a_rotation(name: str):
    axes = SKELETONS[name].axes
    assert axes @ axes.T == pytest.approx(np.eye(3))
    assert np.linalg.det(axes) == pytest.approx(1.0)


@pytest.mark.parametrize("name", sorted(SKELETONS))
def test_a_standing_person_maps_to_the_same_person_up_forward_and_left(name: str):
    source = SKELETONS[name]
    raw = source_frame(source, NEUTRAL)
    out, confidence = source.to_canonical(raw)
    assert confidence == pytest.approx(np.ones(19))
    for joint in ("l_wrist", "r_wrist", "l_ankle", "r_toe", "chest", "head", "pelvis"):
        assert out[INDEX[joint]] == pytest.approx(NEUTRAL[INDEX[joint]], abs=1e-9)


@pytest.mark.parametrize(
    ("name", "joint", "raw", "expected"),
    [
        # camera axes x right in the image, y down, z away: a facing person's left is at +x
        ("k4abt", "l_wrist", [0.4, -0.2, 2.1], [-2.1, 0.4, 0.2]),
        ("mediapipe", "l_wrist", [0.4, -0.2, -0.3], [0.3, 0.4, 0.2]),
        # Kinect v2: x to the sensor's left = the facing person's right, y up
        ("kinect2", "l_wrist", [-0.4, 0.2, 2.1], [-2.1, 0.4, 0.2]),
        ("studio", "l_wrist", [0.1, 0.4, 1.2], [0.1, 0.4, 1.2]),
    ],
)
def test_one_point_is_turned_by_hand(name: str, joint: str, raw: list, expected: list):
    source = SKELETONS[name]
    index = {"k4abt": 7, "mediapipe": 15, "kinect2": 6, "studio": INDEX["l_wrist"]}[name]
    frame = np.zeros((source.num_joints, 3))
    frame[index] = raw
    assert source.to_canonical(frame)[0][INDEX[joint]] == pytest.approx(expected)


@pytest.mark.parametrize(
    ("name", "indices"),
    [
        ("k4abt", dict(l_shoulder=5, l_elbow=6, l_wrist=7, r_shoulder=12, r_wrist=14, l_hip=18,
                       l_knee=19, l_ankle=20, l_toe=21, r_hip=22, r_toe=25, head=26)),
        ("kinect2", dict(l_shoulder=4, l_elbow=5, l_wrist=6, r_shoulder=8, r_wrist=10, l_hip=12,
                         l_knee=13, l_ankle=14, l_toe=15, r_hip=16, r_toe=19, head=3)),
        ("mediapipe", dict(l_shoulder=11, r_shoulder=12, l_elbow=13, l_wrist=15, r_wrist=16,
                           l_hip=23, r_hip=24, l_knee=25, l_ankle=27, r_ankle=28, l_toe=31)),
    ],
)  # fmt: skip
def test_joint_indices_are_those_the_sensors_document(name: str, indices: dict[str, int]):
    source = SKELETONS[name]
    for joint, index in indices.items():
        row = np.zeros(source.num_joints)
        row[index] = 1.0
        assert source.weights[INDEX[joint]] == pytest.approx(row), joint


@pytest.mark.parametrize("name", ["k4abt", "kinect2", "mediapipe"])
def test_the_trunk_is_geometric_whatever_spine_the_sensor_has(name: str):
    source = SKELETONS[name]
    frame = np.random.default_rng(1).normal(size=(source.num_joints, 3))
    p, _ = source.to_canonical(frame)
    mid = {j: 0.5 * (p[INDEX[f"l_{j}"]] + p[INDEX[f"r_{j}"]]) for j in ("hip", "shoulder")}
    assert p[INDEX["pelvis"]] == pytest.approx(mid["hip"])
    assert p[INDEX["chest"]] == pytest.approx(mid["shoulder"])
    assert p[INDEX["spine"]] == pytest.approx(0.5 * (mid["hip"] + mid["shoulder"]))


def test_mediapipe_head_is_the_middle_of_the_ears():
    frame = np.zeros((33, 3))
    frame[7], frame[8] = [0.08, -0.6, 0.0], [-0.08, -0.6, 0.02]
    head = SKELETONS["mediapipe"].to_canonical(frame)[0][INDEX["head"]]
    assert head == pytest.approx([-0.01, 0.0, 0.6])


def test_confidence_is_scaled_by_the_sensor_and_as_low_as_the_least_sure_part():
    confidence = np.full(32, 3.0)
    confidence[18] = 1.0  # left hip guessed: 1 of 2
    confidence[7] = 0.0  # left wrist not seen
    _, sure = SKELETONS["k4abt"].to_canonical(np.zeros((32, 3)), confidence)
    assert sure[INDEX["l_hip"]] == pytest.approx(0.5)
    assert sure[INDEX["pelvis"]] == pytest.approx(0.5)
    assert sure[INDEX["r_hip"]] == pytest.approx(1.0)
    assert sure[INDEX["l_wrist"]] == 0.0


def test_unknown_skeleton_lists_the_known_ones():
    with pytest.raises(StudioError, match="k4abt, kinect2, mediapipe, studio"):
        skeleton("kinect3")


CMU = "Hips LHipJoint LeftHip LeftKnee LeftAnkle LeftToe RightHip RightKnee RightAnkle RightToe "\
    "Neck Head LeftCollar LeftShoulder LeftElbow LeftWrist RightCollar RightShoulder RightElbow "\
    "RightWrist"  # fmt: skip
MOTION_BUILDER = "Hips LHipJoint LeftUpLeg LeftLeg LeftFoot LeftToeBase RightUpLeg RightLeg "\
    "RightFoot RightToeBase Neck Head LeftShoulder LeftArm LeftForeArm LeftHand RightShoulder "\
    "RightArm RightForeArm RightHand"  # fmt: skip
POSER = "hip abdomen chest neck head lCollar lShldr lForeArm lHand lThigh lShin lFoot lToe "\
    "rCollar rShldr rForeArm rHand rThigh rShin rFoot rToe"  # fmt: skip
ACCLAIM = "root lhipjoint lfemur ltibia lfoot ltoes rhipjoint rfemur rtibia rfoot rtoes "\
    "neck head lclavicle lhumerus lradius lwrist rclavicle rhumerus rradius rwrist"  # fmt: skip
BLENDER = "hips thigh.L shin.L foot.L toe.L thigh.R shin.R foot.R toe.R head shoulder.L "\
    "upper_arm.L forearm.L hand.L shoulder.R upper_arm.R forearm.R hand.R"  # fmt: skip


@pytest.mark.parametrize(
    ("names", "found"),
    [
        (CMU, "LeftShoulder LeftElbow LeftWrist LeftHip LeftKnee LeftAnkle LeftToe"),
        (MOTION_BUILDER, "LeftArm LeftForeArm LeftHand LeftUpLeg LeftLeg LeftFoot LeftToeBase"),
        (POSER, "lShldr lForeArm lHand lThigh lShin lFoot lToe"),
        (ACCLAIM, "lhumerus lradius lwrist lfemur ltibia lfoot ltoes"),
        (BLENDER, "upper_arm.L forearm.L hand.L thigh.L shin.L foot.L toe.L"),
    ],
)
@pytest.mark.parametrize(
    "prefix", ["", "mixamorig:", "a:b:", "Character1_", "mixamorig1", "Bob:skel_", "Bip01 "]
)
def test_bvh_names_of_each_convention_are_understood(names: str, found: str, prefix: str):
    joints = names.split()
    source = bvh_skeleton([prefix + n for n in joints])
    canonical = ("shoulder", "elbow", "wrist", "hip", "knee", "ankle", "toe")
    for joint, name in zip(canonical, found.split(), strict=True):
        assert source.weights[INDEX[f"l_{joint}"]][joints.index(name)] == 1.0, joint


def test_a_bvh_without_legs_is_refused_naming_them():
    with pytest.raises(StudioError, match="l_knee"):
        bvh_skeleton(["Hips", "LeftUpLeg", "LeftArm", "RightArm"])


def test_a_joint_a_bvh_lacks_lies_on_its_parent_unseen():
    names = [n for n in MOTION_BUILDER.split() if "Toe" not in n and "Hand" not in n]
    source = bvh_skeleton(names)
    p, sure = source.to_canonical(np.random.default_rng(0).normal(size=(len(names), 3)))
    assert sure[INDEX["l_toe"]] == 0.0
    assert p[INDEX["l_toe"]] == pytest.approx(p[INDEX["l_ankle"]])
    assert sure[INDEX["l_ankle"]] == 1.0


def test_real_kinect_people_stand_upright_facing_the_camera(clips):
    files = sorted(clips.glob("kinect_*.jsonl"))
    assert files
    for file in files:
        frame = json.loads(file.read_text().splitlines()[0])
        p, _ = SKELETONS["k4abt"].to_canonical(frame["positions"], frame["confidence"])
        assert p[INDEX["head"], 2] > p[INDEX["pelvis"], 2] + 0.5 > p[INDEX["l_ankle"], 2] + 1.0
        for joint in ("hip", "shoulder", "knee", "wrist"):
            assert p[INDEX[f"l_{joint}"], 1] > p[INDEX[f"r_{joint}"], 1] + 0.05
        for side in "lr":
            assert p[INDEX[f"{side}_toe"], 0] > p[INDEX[f"{side}_ankle"], 0] + 0.05
