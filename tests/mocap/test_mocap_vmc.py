"""VMC over real UDP: frames in pieces, lost, out of order, another avatar midway, and rubbish."""

import socket
import time
from itertools import pairwise

import numpy as np
import pytest
from vmc_sender import LIMB_JOINTS, MINIMAL, Sender, bones_of, bundle, message, packets

from studio.errors import StudioError
from studio.human.skeleton import INDEX, NEUTRAL
from studio.mocap.osc import MAX_PACKET, read_packet
from studio.mocap.raw_frame import FrameRejected
from studio.mocap.source import TakesNoFrames
from studio.mocap.vmc import HOST, PORT, SILENCE, WANTED, VmcSource, parsed
from studio.mocap.vmc_avatar import KEPT_FRAMES, PARENTS, Avatar
from studio.sources import open_source
from studio.synthetic.operator import OperatorSource

PATIENCE = 20.0
FLOAT32 = 1e-5
"""m: positions of a few metres in 32 bits, summed along a chain of ten bones."""


class Clock:
    """The machine's, and as much as is added."""

    ahead = 0.0

    def __call__(self) -> float:
        return time.monotonic() + self.ahead


@pytest.fixture
def clock():
    return Clock()


@pytest.fixture
def vmc(clock):
    source = VmcSource("vmc:0", "0", clock=clock)
    yield source
    source.close()


@pytest.fixture
def sender(vmc):
    sender = Sender(vmc.port)
    yield sender
    sender.close()


def given_by(source, seconds=PATIENCE):
    """The next pose."""
    deadline = time.monotonic() + seconds
    while (pose := source.read(0.0)) is None:
        assert time.monotonic() < deadline, source.report
        time.sleep(0.001)
    return pose


def until(true):
    deadline = time.monotonic() + PATIENCE
    while not true():
        assert time.monotonic() < deadline
        time.sleep(0.001)


def test_unitys_axes_become_ours_by_hand(vmc, sender):
    """x right, y up, z forward; the left arm, along -x, is turned by 90° about z: it hangs."""
    none, quarter = (0.0, 0.0, 0.0, 1.0), (0.0, 0.0, 0.5**0.5, 0.5**0.5)
    rows = {
        "Hips": (0.0, 1.0, 0.0, *none),
        "Spine": (0.0, 0.2, 0.0, *none),
        "Head": (0.0, 0.5, 0.1, *none),
        "LeftUpperArm": (-0.2, 0.3, 0.0, *quarter),
        "LeftLowerArm": (-0.3, 0.0, 0.0, *none),
        "LeftUpperLeg": (-0.1, 0.0, 0.0, *none),
        "RightUpperLeg": (0.1, 0.0, 0.0, *none),
        "RightLowerLeg": (0.0, -0.45, 0.0, *none),
    }
    root = ("/VMC/Ext/Root/Pos", "root", 0.0, 0.0, 2.0, *none)
    # Turned to the right by 90° about y, forward is x.
    turned = ("/VMC/Ext/Root/Pos", "root", 0.0, 0.0, 2.0, 0.0, 0.5**0.5, 0.0, 0.5**0.5)
    sender.send(bundle(root), *packets(1.0, {k: list(v) for k, v in rows.items()}))
    pose = given_by(vmc)
    at = {joint: pose.joint_pos_w[INDEX[joint]] for joint in INDEX}
    assert at["l_hip"] == pytest.approx([2.0, 0.1, 1.0], abs=FLOAT32)
    assert at["r_knee"] == pytest.approx([2.0, -0.1, 0.55], abs=FLOAT32)
    assert at["l_shoulder"] == pytest.approx([2.0, 0.2, 1.5], abs=FLOAT32)
    assert at["l_elbow"] == pytest.approx([2.0, 0.2, 1.2], abs=FLOAT32)
    assert at["head"] == pytest.approx([2.1, 0.0, 1.7], abs=FLOAT32)
    seen = {joint for joint in INDEX if pose.confidence[INDEX[joint]] > 0.0}
    # chest, spine and neck are made of both shoulders, of which one was never sent
    assert seen == {"pelvis", "head", "l_shoulder", "l_elbow", "l_hip", "r_hip", "r_knee"}
    assert set(vmc.report.joints_missing) == INDEX.keys() - seen
    sender.send(bundle(turned), *packets(1.1, {}))
    pose = given_by(vmc)
    assert pose.joint_pos_w[INDEX["head"]] == pytest.approx([2.0, -0.1, 1.7], abs=FLOAT32)


@pytest.mark.parametrize("bones", [tuple(PARENTS), MINIMAL])
def test_joints_come_out_where_the_avatars_are_however_its_bones_are_turned(bones):
    from studio.mocap.vmc_avatar import VMC

    avatar = Avatar()
    for seed in range(20):
        for name, numbers in bones_of(NEUTRAL + [0.3, -0.2, 0.0], bones, seed).items():
            avatar.set_bone(name, numbers)
        joints = avatar.end_frame()
        assert joints is not None
        joint_pos_w, confidence = VMC.to_canonical(*joints)
        there = [k for k in LIMB_JOINTS if confidence[k] > 0.0]
        assert len(there) == (15 if len(bones) == len(PARENTS) else 13)
        assert joint_pos_w[there] == pytest.approx((NEUTRAL + [0.3, -0.2, 0.0])[there], abs=1e-9)


def test_frames_in_pieces_lost_and_out_of_order_and_another_avatar_midway(vmc, sender):
    """Whatever became of the packets, a pose is the person's of just then or shortly before."""
    rng = np.random.default_rng(7)
    person = OperatorSource("walk", seed=3)
    truth, child, whole, smaller = [], 0.8, 60, 60
    for k in range(whole + smaller):
        pose = person.read(k / 30.0)
        assert pose is not None
        truth.append(pose.joint_pos_w * (1.0 if k < whole else child))
    avatars = tuple(PARENTS), MINIMAL
    poses = []
    for k, joints in enumerate(truth):
        frame = packets(k / 30.0, bones_of(joints, avatars[k >= whole], 1), 4)
        if k < whole + smaller - 12:  # the last arrive as they were sent
            frame = [packet for packet in frame if rng.random() > 0.1]
            for i in np.flatnonzero(rng.random(max(len(frame) - 1, 0)) < 0.2):
                frame[i], frame[i + 1] = frame[i + 1], frame[i]
        sender.send(*frame)
        deadline = time.monotonic() + 1.0 / 30.0
        while time.monotonic() < deadline:
            if (pose := vmc.read(0.0)) is not None:
                poses.append((k, pose))
            time.sleep(0.001)
    assert len(poses) > 0.75 * len(truth)
    assert all(a[1].t < b[1].t for a, b in pairwise(poses))
    knees = [INDEX["l_knee"], INDEX["r_knee"]]
    swing = np.ptp([joints[knees, 0] for joints in truth[:whole]])
    assert swing > 0.3  # m: had a pose been another time's, it would show
    for k, pose in poses:
        known = pose.confidence[LIMB_JOINTS] > 0.0
        assert np.isfinite(pose.joint_pos_w).all()
        before = range(max(k - KEPT_FRAMES - 1, 0), k + 1)
        off = [
            np.abs(pose.joint_pos_w - truth[j])[LIMB_JOINTS][known].max(initial=0.0) for j in before
        ]
        assert min(off) < 0.15, (k, min(off))
    settled = [(k, pose) for k, pose in poses if k >= whole + smaller - 12 + KEPT_FRAMES + 1]
    assert settled
    for k, pose in settled:
        known = pose.confidence > 0.0
        assert not known[[INDEX["l_toe"], INDEX["r_toe"]]].any()
        there = [j for j in LIMB_JOINTS if known[j]]
        assert len(there) == 13
        assert pose.joint_pos_w[there] == pytest.approx(truth[k][there], abs=FLOAT32)
    assert vmc.report.joints_missing == ("l_toe", "r_toe")
    assert vmc.report.up_axis == "y"


def test_no_avatar_gives_no_pose_until_it_is_loaded(vmc, sender):
    frame = bones_of(NEUTRAL)
    sender.send(*packets(0.0, frame))
    given_by(vmc)
    sender.send(message("/VMC/Ext/OK", 0.0), message("/VMC/Ext/T", 0.1))
    sender.send(message("/VMC/Ext/Bone/Pos", "Hips", 1.0))  # counted, once all before is done
    until(lambda: vmc.rejected == 1)
    assert vmc.read(0.0) is None
    sender.send(*packets(0.2, frame))
    assert given_by(vmc).confidence.min() == 1.0


BONE = "/VMC/Ext/Bone/Pos"
GOOD = (0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0)
BAD = [
    b"",
    b"hello",
    b"\0" * 64,
    b"#bundle\0",
    b"#bundle\0" + b"\0" * 8 + b"\xff\xff\xff\xfc",  # of a size of -4: no end to it
    b"#bundle\0" + b"\0" * 8 + b"\0\0\0\0" * 4,
    (b"#bundle\0" + b"\0" * 8 + b"\0\0\0\x14") * 500,
    message(BONE, "Hips", *GOOD)[:-8] + b"",
    message(BONE, "Hips", *GOOD[:6]),
    message(BONE, "Hips"),
    message(BONE),
    message(BONE, 3.0, *GOOD),
    message(BONE, "Hips", *GOOD[:6], "1"),
    message(BONE, "Hips", float("nan"), *GOOD[1:]),
    message(BONE, "Hips", *GOOD[:6], float("inf")),
    message(BONE, "Hips", 1e9, *GOOD[1:]),
    message(BONE, "Hips", *GOOD[:6], 0.0),
    message(BONE, "Hips", *GOOD[:6], 3.0),
    message("/VMC/Ext/Root/Pos", "root", *GOOD[:5]),
    message("/VMC/Ext/T"),
    message("/VMC/Ext/T", "now"),
    message("/VMC/Ext/T", float("nan")),
    message("/VMC/Ext/T", float("inf")),
    message("/VMC/Ext/OK", "yes"),
    b"/VMC/Ext/T\0\0,[[[\0\0\0\0",
    b"/VMC/Ext/T\0\0,tttt\0\0\0",
    b"/VMC/Ext/T\0\0,s\0\0\xff\xfe\xfd\0",
    b"/VMC/Ext/T\0\0,f",
    b"/" + b"x" * MAX_PACKET,
]


def test_what_is_damaged_is_counted_once_each_and_harms_nothing(vmc, sender):
    sender.send(*packets(0.0, bones_of(NEUTRAL)))
    given_by(vmc)
    for count, bad in enumerate(BAD, 1):
        sender.send(bad)
        until(lambda count=count: vmc.rejected >= count)
        assert vmc.rejected == count, bad
    assert len(vmc.report.refused.why) == 5
    # To other addresses, or of bones we have no use for: no concern of ours.
    sender.send(message("/VMC/Ext/Blend/Val", "A", 1.0), message(BONE, "LeftEye", *GOOD))
    sender.send(*packets(0.5, bones_of(NEUTRAL)))
    pose = given_by(vmc)
    assert pose.joint_pos_w[LIMB_JOINTS] == pytest.approx(NEUTRAL[LIMB_JOINTS], abs=FLOAT32)
    assert vmc.rejected == len(BAD)


def mutations(rng, count):
    """Good packets with bytes changed, cut, repeated and put together."""
    seeds = [*packets(0.1, bones_of(NEUTRAL), 4), message(BONE, "Hips", *GOOD), *BAD]
    for _ in range(count):
        packet = bytearray(seeds[rng.integers(len(seeds))][:2000])
        for _ in range(rng.integers(1, 6)):
            at = int(rng.integers(len(packet) + 1))
            kind = rng.integers(4)
            if kind == 0 and at < len(packet):
                packet[at] = rng.integers(256)
            elif kind == 1:
                del packet[at : at + int(rng.integers(1, 16))]
            elif kind == 2:
                packet[at:at] = rng.bytes(int(rng.integers(1, 16)))
            else:
                packet[at:at] = seeds[rng.integers(len(seeds))][: int(rng.integers(64))]
        yield bytes(packet)


@pytest.mark.parametrize(
    "count", [5_000, pytest.param(100_000, marks=pytest.mark.slow)], ids=["some", "many"]
)
def test_any_bytes_are_messages_or_refused(count):
    rng = np.random.default_rng(11)
    avatar, refused, good = Avatar(), 0, 0
    for packet in mutations(rng, count):
        try:
            for address, arguments in read_packet(packet, WANTED):
                words = [isinstance(value, str) for value in arguments]
                if address == BONE and words[:1] == [True] and not any(words[1:]):
                    avatar.set_bone(arguments[0], arguments[1:])
                    good += 1
        except FrameRejected:
            refused += 1
        joints = avatar.end_frame()
        assert joints is None or np.isfinite(joints[0]).all()
    assert refused > 0.3 * count
    assert good > 0.02 * count


def test_a_flood_of_rubbish_leaves_a_source_that_works(vmc, sender, clock):
    sender.send(*mutations(np.random.default_rng(5), 3000))
    until(lambda: vmc.rejected > 100)
    app = Sender(vmc.port)
    clock.ahead = 10.0  # the budget is whole again, and whoever sent has long been silent
    time.sleep(0.5)
    clock.ahead = 20.0
    app.send(*packets(0.0, bones_of(NEUTRAL)))
    pose = given_by(vmc)
    assert pose.joint_pos_w[LIMB_JOINTS] == pytest.approx(NEUTRAL[LIMB_JOINTS], abs=FLOAT32)
    app.close()


def test_a_mistake_of_ours_refuses_a_packet_and_ends_no_thread(vmc, sender, monkeypatch, caplog):
    take, mistakes = VmcSource._take_packet, []

    def mistaken(self, packet, address):
        if len(mistakes) < 3:
            mistakes.append(packet)
            raise ZeroDivisionError
        take(self, packet, address)

    monkeypatch.setattr(VmcSource, "_take_packet", mistaken)
    for k in range(3):  # one at a time: what a full buffer has no room for, the system throws away
        sender.send(message("/VMC/Ext/OK", 1))
        until(lambda k=k: len(mistakes) > k)
    sender.send(*packets(0.0, bones_of(NEUTRAL)))
    given_by(vmc)
    assert any("own fault" in why for why in vmc.report.refused.why)
    assert len([record for record in caplog.records if record.exc_info]) == 1


def test_more_than_its_share_of_bytes_is_refused():
    """By a clock that stands still no share is ever made up for."""
    source = VmcSource("vmc", "0", clock=lambda: 100.0)
    app = Sender(source.port)
    face = bundle(*(("/VMC/Ext/Blend/Val", f"expression {k}", 0.5) for k in range(100)))
    deadline = time.monotonic() + PATIENCE
    while source.rejected == 0:
        assert time.monotonic() < deadline
        app.send(face)
        time.sleep(0.001)
    assert all("MB a second" in why for why in source.report.refused.why)
    app.close()
    source.close()


def test_one_sender_at_a_time_and_another_after_a_silence(vmc, sender, clock):
    other = Sender(vmc.port)
    sender.send(*packets(50.0, bones_of(NEUTRAL)))
    given_by(vmc)
    other.send(message(BONE, "Hips", *GOOD))
    until(lambda: vmc.rejected == 1)
    assert "another sender" in vmc.report.refused.why[0]
    clock.ahead = 2.0 * SILENCE
    other.send(
        *packets(1.0, bones_of(NEUTRAL + [5.0, 0.0, 0.0]))
    )  # its clock and place are its own
    assert given_by(vmc).joint_pos_w[INDEX["head"], 0] == pytest.approx(5.0, abs=FLOAT32)
    assert vmc.rejected == 1
    other.close()


def test_it_hears_this_machine_unless_asked_for_more():
    assert parsed(None) == (HOST, PORT) == ("127.0.0.1", 39539)
    assert parsed("4000") == (HOST, 4000)
    assert parsed("0.0.0.0:4000") == ("0.0.0.0", 4000)
    source = open_source("vmc:0")
    assert isinstance(source, VmcSource)
    assert source.host == "127.0.0.1"
    assert f"127.0.0.1:{source.port}" in source.report.notes[0]
    assert not source.starts_live
    assert source.report.joints_found == {}
    with pytest.raises(TakesNoFrames):
        source.push({})
    source.close()


@pytest.mark.parametrize(
    "spec", ["vmc:x", "vmc:-1", "vmc:65536", "vmc:1.5", "vmc:0.0.0.0:", "vmc:²"]
)
def test_a_port_that_is_none_is_told_what_one_is(spec):
    with pytest.raises(StudioError, match="vmc:39539"):
        open_source(spec)


def test_a_port_in_use_and_a_host_elsewhere_are_told():
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as taken:
        taken.bind(("127.0.0.1", 0))
        with pytest.raises(StudioError, match="stop what listens there"):
            open_source(f"vmc:{taken.getsockname()[1]}")
    with pytest.raises(StudioError, match="cannot listen"):
        open_source("vmc:192.0.2.1:39539")


def test_the_same_source_chosen_again_takes_over(vmc):
    again = VmcSource("vmc", str(vmc.port))
    vmc.close()
    sender = Sender(again.port)
    sender.send(*packets(0.0, bones_of(NEUTRAL)))
    assert given_by(again).confidence.min() == 1.0
    sender.close()
    again.close()
