"""The triplet (q, qd, qdd): layout, differences, one code path live and offline, real people."""

from dataclasses import replace

import numpy as np
import pytest
from canonical_people import NEUTRAL_Q, mirror_pose

from studio.human.calibration import Calibration, calibrate
from studio.human.features import (
    FEATURE_DIM,
    FEATURE_NAMES,
    HEIGHT,
    FeatureExtractor,
    clip_features,
    joints_of,
)
from studio.human.pose import HumanClip, HumanPose
from studio.human.skeleton import BONE_LENGTH, CHAIN, INDEX, NEUTRAL, NEUTRAL_DIRECTION
from studio.mocap.bvh import load_bvh
from studio.mocap.clip_source import ClipSource
from studio.mocap.frames import load_frames
from studio.mocap.source import SourceEnded

ONES = np.ones(19)
NOBODY = HumanPose(t=0.0, joint_pos_w=np.zeros((19, 3)), confidence=np.zeros(19))


def standing(joints: np.ndarray = NEUTRAL) -> HumanPose:
    return HumanPose(t=0.0, joint_pos_w=joints, confidence=ONES)


def arm_up(side: str = "l") -> HumanPose:
    d = NEUTRAL_DIRECTION.copy()
    for bone in ("elbow", "wrist"):
        d[INDEX[f"{side}_{bone}"] - 1] = [0.0, 0.0, 1.0]
    return standing(CHAIN @ (d * BONE_LENGTH[:, None]))


def wandering_clip(seconds: float = 3.0, rate: float = 30.0, seed: int = 0) -> HumanClip:
    """A person whose bones swing smoothly; every joint is unseen in a twentieth of the frames."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(seconds * rate)) / rate
    phase, frequency = rng.uniform(0, 6, (18, 3)), rng.uniform(0.3, 1.2, (18, 3))
    swing = 0.1 * np.sin(2 * np.pi * frequency * t[:, None, None] + phase)
    return HumanClip(
        name="wander",
        t=t,
        joint_pos_w=CHAIN @ (NEUTRAL_DIRECTION * BONE_LENGTH[:, None] + swing),
        confidence=np.where(rng.random((len(t), 19)) < 0.05, 0.0, 1.0),
    )


def test_layout_names_every_feature():
    assert FEATURE_DIM == len(FEATURE_NAMES) == 18 * 3 + 1
    assert FEATURE_NAMES[0] == "spine.x"
    assert FEATURE_NAMES[HEIGHT] == "height"
    k = FEATURE_NAMES.index("l_wrist.z")
    assert NEUTRAL_Q[k] == pytest.approx(NEUTRAL[INDEX["l_wrist"], 2] - NEUTRAL[0, 2])
    # pelvis .43 + .42 + .08 = .93 m above the sole, legs of .85 m
    assert NEUTRAL_Q[HEIGHT] == pytest.approx(0.93 / 0.85)
    assert joints_of(NEUTRAL_Q) == pytest.approx(NEUTRAL)


def test_a_still_person_has_no_velocity_from_the_first_frame_on():
    extractor = FeatureExtractor()
    for _ in range(10):
        features = extractor.push(standing())
        assert features.q == pytest.approx(NEUTRAL_Q)
        assert not features.qd.any()
        assert not features.qdd.any()
    assert features.joints == pytest.approx(NEUTRAL)


def test_differences_reach_back_exactly_three_and_six_frames():
    q, qd, qdd = clip_features(wandering_clip())
    assert qd[6:] == pytest.approx((q[6:] - q[3:-3]) / 0.1)
    assert qdd[6:] == pytest.approx((q[6:] - 2 * q[3:-3] + q[:-6]) / 0.01)
    assert qdd[9:] == pytest.approx((qd[9:] - qd[6:-3]) / 0.1)


def test_features_are_causal():
    clip = wandering_clip()
    changed = clip.joint_pos_w.copy()
    changed[50:] = NEUTRAL
    other = replace(clip, joint_pos_w=changed)
    for a, b in zip(clip_features(clip), clip_features(other), strict=True):
        assert (a[:50] == b[:50]).all()
        assert (a[50:] != b[50:]).any()


def test_a_clip_gives_the_same_features_offline_as_pushed_by_a_source():
    clip = wandering_clip(rate=120.0)
    offline = clip_features(clip.at_rate(30), Calibration(heading=0.2))
    source, extractor = ClipSource(clip), FeatureExtractor(Calibration(heading=0.2))
    live = []
    for k in range(10**6):
        try:
            pose = source.read(k / 30)
        except SourceEnded:
            break
        assert pose is not None
        live.append(extractor.push(pose))
    assert len(live) == len(offline[0])
    for a, name in zip(offline, ("q", "qd", "qdd"), strict=True):
        assert (a == np.array([getattr(f, name) for f in live])).all()


def test_a_clip_of_another_rate_is_refused():
    with pytest.raises(ValueError, match="at_rate"):
        clip_features(wandering_clip(rate=60.0))


def test_mirrored_features_are_those_of_the_mirror_image():
    clip = wandering_clip()
    poses = [mirror_pose(clip[i]) for i in range(len(clip))]
    image = replace(
        clip,
        joint_pos_w=np.array([p.joint_pos_w for p in poses]),
        confidence=np.array([p.confidence for p in poses]),
    )
    calibration = Calibration(heading=0.4, seconds=30.0)
    mirrored = clip_features(clip, calibration, mirror=True)
    of_image = clip_features(image, calibration.mirrored())
    for a, b in zip(mirrored, of_image, strict=True):
        assert a == pytest.approx(b, abs=1e-9)


def test_first_pose_is_not_taken_for_neutral():
    extractor = FeatureExtractor()
    up = FEATURE_NAMES.index("l_wrist.z")
    q = [extractor.push(arm_up()).q for _ in range(90)]
    assert np.array(q)[:, up] == pytest.approx(np.full(90, 0.50 + 0.29 + 0.25), abs=0.01)


def test_a_lost_person_is_held_for_half_a_second_and_then_eases_to_neutral():
    for lost in (None, NOBODY):
        extractor = FeatureExtractor()
        for _ in range(30):
            before = extractor.push(arm_up()).q
        q = np.array([extractor.push(lost).q for _ in range(120)])
        assert q[:15] == pytest.approx(np.tile(before, (15, 1)))
        assert np.abs(np.diff(q, axis=0)).max() < 0.06
        assert q[-1] == pytest.approx(NEUTRAL_Q, abs=0.02)
        assert extractor.push(lost).unseen == pytest.approx(121 / 30)
        assert extractor.push(standing()).unseen == 0.0


def test_a_march_goes_on_as_it_went_while_its_frames_are_lost():
    """As the puppeteer says it: the last pose comes again and again."""

    def marching(k: int) -> HumanPose:
        up = np.sin(2.0 * np.pi * k / 30.0)
        d = NEUTRAL_DIRECTION.copy()
        for side, lift in (("l", max(up, 0.0)), ("r", max(-up, 0.0))):
            d[INDEX[f"{side}_knee"] - 1] = [np.sin(lift), 0.0, -np.cos(lift)]
        return standing(CHAIN @ (d * BONE_LENGTH[:, None]))

    seen, lost = FeatureExtractor(), FeatureExtractor()
    for k in range(95):
        seen.push(marching(k))
        lost.push(last := marching(k))
    knees = [FEATURE_NAMES.index(f"{side}_knee.x") for side in "lr"]
    there = np.array([seen.push(marching(95 + k)).q[knees] for k in range(15)])
    guessed = np.array([lost.push(last).q[knees] for _ in range(15)])
    assert np.ptp(there, axis=0).max() > 0.2
    assert np.abs(guessed - there).max() < 0.02
    still = FeatureExtractor()
    held = np.array([still.push(last).q for _ in range(60)])
    assert held == pytest.approx(np.tile(held[0], (60, 1)))  # who does not march stays


def test_an_unseen_wrist_is_held_while_the_rest_moves():
    extractor = FeatureExtractor()
    for _ in range(30):
        extractor.push(arm_up())
    confidence = ONES.copy()
    confidence[INDEX["l_wrist"]] = 0.1
    wild = arm_up("r").joint_pos_w.copy()
    wild[INDEX["l_wrist"]] = [50.0, -3.0, 9.0]
    for _ in range(10):
        q = extractor.push(HumanPose(t=0.0, joint_pos_w=wild, confidence=confidence)).q
    joints = joints_of(q)
    forearm = joints[INDEX["l_wrist"]] - joints[INDEX["l_elbow"]]
    assert forearm / np.linalg.norm(forearm) == pytest.approx([0, 0, 1], abs=0.05)
    assert joints[INDEX["r_wrist"], 2] > 1.6


def test_a_bone_of_impossible_length_is_held_like_one_unseen():
    extractor = FeatureExtractor(Calibration(seconds=30.0))
    for _ in range(10):
        before = extractor.push(standing()).q
    glitch = NEUTRAL.copy()
    glitch[INDEX["l_wrist"]] = glitch[INDEX["l_elbow"]] + [0.6, 0.0, 0.0]
    assert extractor.push(standing(glitch)).q == pytest.approx(before)


def test_reset_forgets_everything():
    extractor = FeatureExtractor(Calibration(heading=0.1))
    clip = wandering_clip()
    first = np.array([extractor.push(clip[i]).qdd for i in range(30)])
    extractor.reset()
    assert (np.array([extractor.push(clip[i]).qdd for i in range(30)]) == first).all()


def test_at_rate_gives_the_newest_frame_so_far():
    clip = wandering_clip(seconds=1.0, rate=120.0)
    slow = clip.at_rate(30)
    assert len(slow) == 30  # one second
    assert np.diff(slow.t) == pytest.approx(np.full(29, 1 / 30))
    # at 1/30 s (+ half a period of tolerance, 1/60 s) frame 5 of 120 Hz (t = .0417) is the newest
    assert (slow.joint_pos_w[1] == clip.joint_pos_w[5]).all()


KNEE_BEND = {  # file: the deepest knee flexion, degrees, both legs, roughly
    "cmu_13_29_squats.bvh": (130, 160),
    "cmu_13_29_arm_circles.bvh": (10, 35),
    "cmu_13_29_march_in_place.bvh": (100, 135),
    "kinect_m01_deep_squat.jsonl": (105, 135),
    "kinect_m07_arm_abduction.jsonl": (0, 20),
}


def _flexion(joints: np.ndarray, side: str) -> np.ndarray:
    thigh = joints[:, INDEX[f"{side}_knee"]] - joints[:, INDEX[f"{side}_hip"]]
    shin = joints[:, INDEX[f"{side}_ankle"]] - joints[:, INDEX[f"{side}_knee"]]
    return np.degrees(np.arccos(np.clip((thigh * shin).sum(-1) / (0.43 * 0.42), -1, 1)))


def test_real_people_stand_on_their_feet_upright_and_face_forward(clips):
    files = sorted([*clips.glob("*.bvh"), *clips.glob("*.jsonl")])
    assert files
    for file in files:
        clip = load_bvh(file) if file.suffix == ".bvh" else load_frames(file)[0]
        clip = clip.at_rate(30)
        q, _, _ = clip_features(clip, calibrate([clip[i] for i in range(len(clip))]))
        joints = joints_of(q)
        middle = np.median(joints, axis=0)
        assert middle[INDEX["chest"], 2] > middle[INDEX["pelvis"], 2] + 0.4, file.name
        assert middle[INDEX["head"], 2] > middle[INDEX["chest"], 2] + 0.1, file.name
        for joint in ("shoulder", "hip"):
            across = middle[INDEX[f"l_{joint}"]] - middle[INDEX[f"r_{joint}"]]
            assert across[1] > 0.15, file.name
            assert abs(across[0]) < 0.5 * across[1], file.name
        toes = [middle[INDEX[f"{s}_toe"], 0] - middle[INDEX[f"{s}_ankle"], 0] for s in "lr"]
        assert min(toes) > 0.05, file.name
        if file.name in KNEE_BEND:
            low, high = KNEE_BEND[file.name]
            assert low < _flexion(joints, "l").max() < high, file.name
            assert low < _flexion(joints, "r").max() < high, file.name


def test_a_real_arm_raise_is_on_the_right_side_and_the_other_arm_hangs(clips):
    file = clips / "kinect_m07_arm_abduction.jsonl"
    if not file.exists():
        pytest.skip("kinect_m07_arm_abduction.jsonl is not among the clips")
    clip = load_frames(file)[0].at_rate(30)
    q, _, _ = clip_features(clip, calibrate([clip[i] for i in range(len(clip))]))
    wrists = joints_of(q)[:, [INDEX["l_wrist"], INDEX["r_wrist"]], 2]
    assert wrists[:, 0].max() < 1.0
    assert wrists[:, 1].max() > 1.8
