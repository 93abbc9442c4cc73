"""A headset's frames: what they show is kept, the rest is inferred and said to be, and drives."""

import json
import math

import numpy as np
import pytest

from studio.geometry import quat_to_rpy
from studio.human.calibration import calibrate
from studio.human.posture import SEEN
from studio.human.skeleton import INDEX, NUM_JOINTS
from studio.mocap.raw_frame import FrameRejected
from studio.puppeteer import Puppeteer
from studio.synthetic.headset import BODY, HeadsetSource
from studio.synthetic.headset_person import INFERRED, arm_to

TALL = 1.65
HANDS = {"left": [-0.25, 0.85, -0.1], "right": [0.25, 0.85, -0.1]}


def frame(t, head=(0.0, TALL, 0.0), turned=(0.0, 0.0, 0.0, 1.0), **more):
    """Upright, hands hanging, the stick at rest, unless told."""
    return {"t": t, "head": [*head, *turned], **HANDS, **more}


def about(axis, angle):
    """Quaternion x y z w."""
    return (*(math.sin(angle / 2) * np.array(axis, float)).tolist(), math.cos(angle / 2))


def source():
    clock = [0.0]
    opened = HeadsetSource(clock=lambda: clock[0])
    opened.new_sender()
    return opened, clock


def poses(frames):
    """The pose made of each frame, 30 a second."""
    opened, clock = source()
    out = []
    for k, made in enumerate(frames):
        clock[0] = k / 30
        opened.push(made)
        out.append(opened.read(0.0))
    return out


def driven(change, seconds=5.0):
    """Ticks of a robot that follows who stands for 1.5 s and then does `change(share)`."""
    opened, clock = source()
    puppeteer = Puppeteer(calibration=calibrate(opened.calibration_poses()))
    ticks = []
    for k in range(round(30 * seconds)):
        clock[0] = k / 30
        share = min(max(k / 30 - 1.5, 0.0), 1.0)
        opened.push(frame(k / 30, **change(share)))
        ticks.append(puppeteer.step(opened.read(0.0)))
    return ticks


def test_what_is_tracked_is_sure_and_what_is_guessed_is_not():
    pose = poses([frame(0.0)])[0]
    sure = {name for name, k in INDEX.items() if pose.confidence[k] == 1.0}
    assert sure == {"head", "l_wrist", "r_wrist"}
    others = [k for name, k in INDEX.items() if name not in sure]
    assert (pose.confidence[others] == INFERRED).all()
    assert SEEN < INFERRED < 1.0


def test_a_hand_that_is_not_tracked_is_no_hand_at_all():
    opened, _ = source()
    opened.push(frame(0.0, left=None))
    pose = opened.read(0.0)
    assert pose is not None
    assert pose.confidence[[INDEX["l_elbow"], INDEX["l_wrist"]]].max() == 0.0
    assert set(opened.report.joints_found) == {"head", "r_wrist"}
    assert "inferred" in opened.report.notes[0]


@pytest.mark.parametrize("tall", [1.1, 1.5, 1.9])
def test_hands_are_where_they_are_from_the_head_whoever_wears_it(tall):
    left = (-0.2, tall - 0.3, -0.1)
    pose = poses([frame(0.0, head=(0.0, tall, 0.0), left=left)])[0]
    arm = pose.joint_pos_w[INDEX["l_wrist"]] - pose.joint_pos_w[INDEX["head"]]
    # From the middle between the ears, 8 cm behind the eyes and 3 cm lower.
    assert arm == pytest.approx([0.18, 0.2, -0.27], abs=1e-3)
    assert np.ptp(pose.joint_pos_w[:, 2]) == pytest.approx(tall, abs=0.15)


def test_an_arm_keeps_its_bones_and_reaches_as_far_as_it_can():
    shoulder = np.array([0.0, 0.2, 1.4])
    for goal in ([0.3, 0.3, 1.2], [0.0, 0.2, 1.9], [2.0, 0.2, 1.4], [0.0, 0.2, 1.4]):
        elbow, wrist = arm_to(shoulder, np.array(goal), 1.0, 0.32, 0.25)
        assert np.linalg.norm(elbow - shoulder) == pytest.approx(0.32)
        assert np.linalg.norm(wrist - elbow) == pytest.approx(0.25)
    elbow, wrist = arm_to(shoulder, np.array([0.4, 0.2, 1.4]), 1.0, 0.32, 0.25)
    assert wrist == pytest.approx([0.4, 0.2, 1.4])
    assert elbow[2] < 1.4, "an elbow hangs"


def test_whoever_turns_round_in_the_room_still_faces_ahead():
    turns = [frame(k / 30, turned=about((0, 1, 0), 0.03 * k)) for k in range(100)]
    pose = poses(turns)[-1]
    hips = pose.joint_pos_w[INDEX["l_hip"]] - pose.joint_pos_w[INDEX["r_hip"]]
    assert abs(math.degrees(math.atan2(-hips[0], hips[1]))) < 45.0


def test_a_step_aside_is_soon_no_lean():
    def at(k):
        return (0.3 * min(max((k - 30) / 30, 0.0), 1.0), TALL, 0.0)

    frames = [frame(k / 30, head=at(k)) for k in range(210)]
    tilts = [pose.joint_pos_w[INDEX["chest"], 1] for pose in poses(frames)]
    assert abs(tilts[-1]) < 0.5 * max(map(abs, tilts))


def test_who_leans_makes_the_robot_lean_the_same_way():
    ahead = driven(lambda s: {"head": (0.0, TALL - 0.08 * s, -0.2 * s)})[-1]
    right = driven(lambda s: {"head": (0.2 * s, TALL - 0.05 * s, 0.0)})[-1]
    tilted = driven(lambda s: {"turned": about((0, 0, 1), -0.5 * s)})[-1]
    assert np.degrees(quat_to_rpy(ahead.reference.base_quat))[1] > 8.0
    assert np.degrees(quat_to_rpy(right.reference.base_quat))[0] > 8.0
    assert np.degrees(quat_to_rpy(tilted.reference.base_quat))[0] > 4.0


@pytest.mark.parametrize(("side", "paw"), [("right", 0), ("left", 1)])
def test_who_raises_a_controller_makes_that_paw_rise(side, paw):
    x = HANDS[side][0]
    tick = driven(lambda s: {side: [x, 0.85 + s, -0.1 - 0.2 * s]})[-1]
    feet = tick.robot.foot_pos_w[:, 2]
    assert feet[paw] > 0.15
    assert feet[1 - paw] < 0.05


def test_who_goes_down_crouches_and_then_sits():
    crouch = driven(lambda s: {"head": (0.0, TALL - 0.15 * s, 0.0)})[-1]
    assert crouch.expert == "stand"
    assert crouch.reference.base_pos[2] < 0.22
    squat = driven(lambda s: {"head": (0.0, TALL - 0.42 * s, 0.0)})[-1]
    assert squat.state == "sit"


def test_the_stick_walks_and_at_rest_the_robot_stands():
    def pushed(forward, right):
        return driven(lambda s: {"stick": [right * (s > 0), -forward * (s > 0)]}, 8.0)

    quick, slow = pushed(1.0, 0.0)[-1], pushed(0.5, 0.0)[-1]
    assert quick.state == slow.state == "walk"
    assert quick.robot.base_pos[0] > 1.5 * slow.robot.base_pos[0] > 0.3
    left = quat_to_rpy(pushed(0.6, -1.0)[-1].reference.base_quat)[2]
    assert np.degrees(left) > 10.0
    assert {t.state for t in driven(lambda s: {"stick": [0.1, -0.1]})} == {"stand"}
    ticks = driven(lambda s: {"stick": [0.0, -1.0 if 0 < s < 1 else 0.0]}, 6.0)
    assert "walk" in {t.expert for t in ticks}
    assert ticks[-1].state == "stand"


def body_at(**moved):
    """A body that the browser tracks, of somebody whose arms hang, in WebXR's axes."""
    up = {"arm-upper": 1.4, "arm-lower": 1.1, "hand-wrist": 0.85,
          "upper-leg": 0.92, "lower-leg": 0.5, "foot-ankle": 0.08, "foot-ball": 0.03}  # fmt: skip
    out = []
    for name in BODY.joints:
        side, _, part = name.partition("-")
        x = {"left": -0.2, "right": 0.2}.get(side, 0.0) * (0.5 if up.get(part, 1) < 1 else 1)
        out.append([x, up.get(part, 1.55), -0.1 if part == "foot-ball" else 0.0])
        out[-1] = moved.get(name.replace("-", "_"), out[-1])
    return out


def test_a_body_that_the_browser_tracks_is_taken_but_for_legs():
    elbow = [-0.5, 1.4, 0.0]
    pose = poses([frame(0.0, body=body_at(left_arm_lower=elbow))])[0]
    sure = pose.confidence
    assert pose.joint_pos_w[INDEX["l_elbow"], 1:] == pytest.approx([0.5, 1.4])
    assert sure[INDEX["l_elbow"]] == sure[INDEX["chest"]] == 1.0
    assert sure[INDEX["l_knee"]] == sure[INDEX["r_toe"]] == INFERRED
    lost = poses([frame(0.0, body=body_at(left_arm_upper=None))])[0]
    assert lost.confidence[INDEX["chest"]] == INFERRED, "no trunk: head and hands say more"
    assert BODY.num_joints + 4 == NUM_JOINTS


@pytest.mark.parametrize(
    ("bad", "why"),
    [
        ("{", "a headset's frame is"),
        (frame(0.0, head=(0.0, math.nan, 0.0)), "metres"),
        (frame(0.0, left=[0.0, 1e9, 0.0]), "metres"),
        (frame(0.0, turned=(0.0, 0.0, 0.0, 0.0)), "rotation"),
        (frame(0.0, stick=[0.0, math.inf]), "stick"),
        (frame(0.0, body=[[0.0, 0.0, 0.0]]), "15"),
        (frame(0.0, body=[[math.inf, 0.0, 0.0]] * 15), "metres"),
        ({"t": 0.0, "skeleton": "studio", "positions": [[0, 0, 0]] * 19}, "head"),
        (3, "headset's frame"),
        ("x" * 70_000, "at most"),
    ],
)
def test_what_is_no_frame_of_a_headset_is_refused_and_counted(bad, why):
    opened, _ = source()
    with pytest.raises(FrameRejected, match=why):
        opened.push(bad)
    assert opened.rejected == 1
    assert opened.read(0.0) is None
    opened.push(frame(0.1))
    assert opened.read(0.0) is not None


def test_more_frames_than_a_person_needs_are_refused_before_they_are_read(monkeypatch):
    opened, _ = source()
    for k in range(30):
        opened.push(frame(k / 1000))
    monkeypatch.setattr("studio.synthetic.headset.worn", lambda raw: pytest.fail("read"))
    with pytest.raises(FrameRejected, match="frames a second"):
        opened.push(frame(1.0))


def test_of_frames_with_anything_in_them_each_is_refused_or_makes_a_person():
    rng = np.random.default_rng(1)
    opened, clock = source()
    odd = [None, "x", [], True, 1e9, -1e308, math.nan, math.inf, 0.0]
    made = 0
    for k in range(2000):
        clock[0] = k / 30
        one = frame(k / 30, stick=rng.normal(size=2).tolist(), body=body_at())
        key = str(rng.choice(list(one)))
        value = odd[rng.integers(len(odd))]
        if isinstance(one[key], list) and rng.random() < 0.7:
            one[key] = [*one[key]]
            one[key][rng.integers(len(one[key]))] = value
        elif rng.random() < 0.7:
            one[key] = value
        try:
            opened.push(json.dumps(one) if rng.random() < 0.7 else one)
        except FrameRejected:
            continue
        made += 1
        pose = opened.read(0.0)
        assert pose is not None
        assert np.isfinite(pose.joint_pos_w).all()
        assert ((pose.confidence >= 0.0) & (pose.confidence <= 1.0)).all()
    assert 200 < made < 1800
    assert opened.rejected == 2000 - made
