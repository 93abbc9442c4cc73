"""Every entry of the source registry keeps the contract of a Source; files, streams, bad specs."""

import contextlib
import json
import math
import threading
import time
from pathlib import Path

import numpy as np
import pytest
import vmc_sender
from human_frames import object_of

from studio.errors import StudioError
from studio.human.pose import HumanClip, HumanPose
from studio.human.skeleton import INDEX, NEUTRAL
from studio.mocap.clip_source import ClipSource
from studio.mocap.frames import load_frames
from studio.mocap.raw_frame import FrameRejected
from studio.mocap.source import TakesNoFrames
from studio.mocap.source import poses as source_poses
from studio.mocap.stream import StreamSource
from studio.mocap.video import PYTHON
from studio.mocap.vmc import VmcSource
from studio.reference.intent import Intent
from studio.robot.pose import ReferencePose, RobotState
from studio.sources import SOURCES, Source, SourceEnded, open_source, spec_of, usages
from studio.synthetic.impaired import Impaired, Impairment
from studio.synthetic.operator import FollowingOperator, InteractiveOperator
from studio.takes.record.recorder import Recorder
from studio.takes.tick import Tick

LIVE = [name for name, kind in SOURCES.items() if kind.served]
FED = [name for name in LIVE if name not in ("vmc", "headset")]
"""Sources that give the person that is sent to them; vmc hears packets, a headset shows less."""


APPS: dict[int, vmc_sender.Sender] = {}
"""Who sends VMC, by the port it goes to."""


def frame(t: float, shift: float = 0.0) -> dict:
    positions = (NEUTRAL + [shift, 0.0, 0.0]).tolist()
    return {"t": t, "skeleton": "studio", "positions": positions}


def poses(count: int = 40) -> list[HumanPose]:
    return [
        HumanPose(t=k / 30, joint_pos_w=NEUTRAL + [0.01 * k, 0, 0], confidence=np.ones(19))
        for k in range(count)
    ]


def write_frames(path: Path, lines: list[str] | None = None) -> Path:
    lines = [json.dumps(object_of(p)) for p in poses()] if lines is None else lines
    path.write_text("\n".join(lines) + "\n")
    return path


def write_bvh(path: Path) -> Path:
    def limb(side: str, x: int, y: int, names: tuple[str, ...], dy: int) -> str:
        out = ""
        for k, name in enumerate(names):
            offset = f"{x} {y} 0" if k == 0 else f"0 {dy} 0"
            out += f"JOINT {side}{name} {{ OFFSET {offset} CHANNELS 1 Xrotation\n"
        return out + "}" * len(names) + "\n"

    legs, arms = ("UpLeg", "Leg", "Foot"), ("Arm", "ForeArm", "Hand")
    body = "".join(
        limb(side, sign * 10, 0, legs, -42) + limb(side, sign * 18, 50, arms, -27)
        for side, sign in (("Left", 1), ("Right", -1))
    )
    head = "HIERARCHY\nROOT Hips { OFFSET 0 0 0 CHANNELS 3 Xposition Yposition Zposition\n"
    rows = "\n".join(f"0 92 {k}" + " 0" * 12 for k in range(40))
    timing = "MOTION\nFrames: 40\nFrame Time: 0.0333333\n"
    path.write_text(head + body + "}\n" + timing + rows)
    return path


def write_video(path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A file, and in place of the model (an extra; `test_mocap_video`) what it would say of it."""
    frames = write_frames(path.with_suffix(".said"))
    program = path.with_suffix(".program")
    told = json.dumps({"pictures": 40, "whole": True})
    program.write_text(f"#!/bin/sh\ncat '{frames}'\necho '{told}' >&2\n")
    program.chmod(0o755)
    monkeypatch.setenv(PYTHON, str(program))
    path.write_bytes(b"pictures")
    return path


def record_take(sessions: Path) -> str:
    """A take of a person and a robot that stands, recorded as the studio records; its name."""
    joint_pos, zero = np.tile([0.0, 0.8, -1.6], 4), np.zeros(3)
    still = {
        "base_pos": np.array([0.0, 0.0, 0.3]),
        "base_quat": np.array([1.0, 0.0, 0.0, 0.0]),
        "joint_pos": joint_pos,
        "foot_contact": np.ones(4),
        "base_lin_vel_w": zero,
        "base_ang_vel_b": zero,
        "joint_vel": np.zeros(12),
    }
    recorder = Recorder(sessions)
    name = recorder.start(name="walk-1")
    for k, pose in enumerate(poses()):
        recorder.append(
            Tick(
                index=k, t=pose.t, human=pose, human_fresh=True, expert="stand", votes={},
                state="stand", transition_to=None, mode="live", controller="stand_still",
                reference=ReferencePose(**still), action=joint_pos, target=joint_pos,
                robot=RobotState(
                    **still, t=pose.t, foot_pos_w=np.zeros((4, 3)), torque=np.zeros(12)
                ),
                clipped=False, fallen=False,
            )
        )  # fmt: skip
    recorder.stop()
    recorder.close()
    return name


@pytest.fixture
def opened(tmp_path: Path, monkeypatch: pytest.MonkeyPatch):
    """Opens any registered source by its first word, with something to play."""
    made: list[Source] = []

    def open_one(name: str) -> Source:
        spec = {
            "bvh": lambda: f"bvh:{write_bvh(tmp_path / 'a.bvh')}",
            "frames": lambda: f"frames:{write_frames(tmp_path / 'a.jsonl')}",
            "take": lambda: f"take:{record_take(tmp_path)}",
            "vmc": lambda: "vmc:0",
            "video": lambda: f"video:{write_video(tmp_path / 'a.mp4', monkeypatch)}",
        }.get(name, lambda: name)()
        source = open_source(spec, seed=1, sessions=tmp_path)
        made.append(source)
        return source

    yield open_one
    for source in made:
        source.close()
    while APPS:
        APPS.popitem()[1].close()


def feed(source: Source, k: int) -> None:
    if isinstance(source, VmcSource):
        app = APPS.get(source.port) or vmc_sender.Sender(source.port)
        APPS[source.port] = app
        before = source._gate.accepted
        app.send(*vmc_sender.packets(k / 30, vmc_sender.bones_of(NEUTRAL + [0.01 * k, 0, 0])))
        while source._gate.accepted == before:
            time.sleep(0.001)
    with contextlib.suppress(TakesNoFrames):
        worn = {"t": k / 30, "head": [0.01 * k, 1.6, 0, 0, 0, 0, 1]}
        source.push(worn if source.name == "headset" else frame(k / 30, 0.01 * k))


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_gives_poses_forward_in_time_until_it_ends(opened, name):
    source = opened(name)
    assert isinstance(source, Source)
    assert source.name.partition(":")[0] == name
    assert source.rejected == 0
    given: list[HumanPose] = []
    ended_at = None
    for k in range(90):
        feed(source, k) if k < 25 else None
        try:
            pose = source.read(k / 30)
        except SourceEnded:
            ended_at = k
            break
        if pose is not None:
            given.append(pose)
            assert np.isfinite(pose.joint_pos_w).all()
            assert ((pose.confidence >= 0) & (pose.confidence <= 1)).all()
            seen = pose.joint_pos_w[pose.confidence >= 0.3]
            assert np.ptp(seen[:, 2]) < 3.0  # metres
    assert len(given) >= 25
    assert (np.diff([p.t for p in given]) > 0).all()
    if source.duration is None:
        assert ended_at is None
    else:
        assert source.duration == pytest.approx(39 / 30, abs=0.04)
        assert ended_at == 40
        with pytest.raises(SourceEnded):
            source.read(100.0)


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_gives_a_pose_once_and_none_until_there_is_a_newer(opened, name):
    source = opened(name)
    feed(source, 0)
    assert source.read(0.0) is not None
    assert source.read(0.0) is None


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_calibrates_from_what_it_can_and_closes_twice(opened, name):
    source = opened(name)
    scanned = source.calibration_poses()
    assert isinstance(source.starts_live, bool)
    assert source.starts_live == (name not in LIVE)
    if source.duration is not None:
        assert len(scanned) >= 10
    for pose in scanned:
        assert pose.joint_pos_w.shape == (19, 3)
    source.close()
    source.close()


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_takes_frames_or_says_where_they_go(opened, name):
    source = opened(name)
    source.new_sender()
    if name in FED:
        source.push(frame(0.0))
        given = source.read(0.0)
        assert given is not None
        assert given.joint_pos_w == pytest.approx(NEUTRAL)
    elif name == "headset":
        with pytest.raises(FrameRejected, match="a headset's frame is"):
            source.push(frame(0.0))
        return
    else:
        with pytest.raises(TakesNoFrames, match="set the source to stream") as refused:
            source.push(frame(0.0))
        assert source.name in str(refused.value)
    assert source.rejected == 0


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_says_what_may_be_done_with_it(opened, name):
    """Whether nobody drives, which take it plays, and who acts in its place while collecting."""
    source = opened(name)
    assert source.label.partition(" ")[0] == name
    assert source.tours == (name == "operator")
    assert source.take == ("walk-1" if name == "take" else None)
    person = source.stand_in(seed=1, style="circles")
    assert (person is not None) == (name == "operator")
    if person is not None:
        person.show(Intent(state="stand"))
        assert person.read(0.0) is not None
        assert person.stand_in(seed=1, style="circles") is None


@pytest.mark.parametrize("name", [*sorted(SOURCES), "interactive", "follow"])
def test_every_source_can_be_told_and_shown_what_is_meant(opened, name):
    """Whoever cannot use it goes on as before; who can, moves."""
    source = {
        "interactive": lambda: InteractiveOperator(seed=1),
        "follow": lambda: FollowingOperator(seed=1),
    }.get(name, lambda: opened(name))()
    source.set_style("circles")
    given = []
    for k in range(30):
        feed(source, k)
        source.set_intent(Intent(reach=np.array([1.0, 0.0])))
        source.show(Intent(reach=np.array([1.0, 0.0])))
        given.append(source.read(k / 30))
    assert all(pose is not None and np.isfinite(pose.joint_pos_w).all() for pose in given)
    raised = given[-1].joint_pos_w[INDEX["r_wrist"], 2] - given[-1].joint_pos_w[INDEX["head"], 2]
    assert (raised > 0.0) == (name in ("interactive", "follow"))


@pytest.mark.parametrize("name", sorted(SOURCES))
def test_every_source_says_how_it_is_written_and_what_it_is(name):
    kind = SOURCES[name]
    assert kind.usage.partition(":")[0].removesuffix("[") == name
    assert kind.about


@pytest.mark.parametrize(
    ("spec", "message"),
    [
        ("kinect", "known: " + ", ".join(sorted(usages()))),
        ("webcam:0", "takes no argument"),
        ("vmc:here", "write vmc, vmc:39539"),
        ("", "known: "),
        ("BVH:x", "known: "),
        ("bvh", "needs bvh:FILE"),
        ("bvh:", "needs bvh:FILE"),
        ("frames:", "needs frames:FILE"),
        ("take", "needs take:NAME"),
        ("take:nowhere", "nowhere"),
        ("take:../../etc", "take"),
        ("stream:8080", "takes no argument"),
        ("bvh:/nowhere/x.bvh", "cannot read"),
        ("frames:/nowhere/x.jsonl", "cannot read"),
        ("frames:/", "cannot read"),
        ("bvh:a\0b", "cannot read"),
        ("frames:a\0b", "cannot read"),
    ],
)
def test_a_bad_spec_is_refused_saying_what_would_work(spec, message):
    with pytest.raises(StudioError) as e:
        open_source(spec)
    assert message in str(e.value)
    assert "\n" not in str(e.value)


def test_an_unknown_task_of_the_operator_lists_the_known_ones():
    with pytest.raises(StudioError, match="known"):
        open_source("operator:juggle")


def test_bad_lines_of_a_file_are_refused_and_counted(tmp_path):
    lines = [json.dumps(object_of(p)) for p in poses(6)]
    lines[1] = "not json"
    lines[3] = lines[3].replace("0.0", "Infinity", 1)
    lines[4:4] = ["", lines[0]]  # blank is fine; the first again is time going backwards
    clip, rejected = load_frames(write_frames(tmp_path / "a.jsonl", lines))
    assert (len(clip), rejected) == (4, 3)
    assert clip.t == pytest.approx([0, 2 / 30, 4 / 30, 5 / 30])
    assert open_source(f"frames:{tmp_path / 'a.jsonl'}").rejected == 3


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (b"", "it is empty"),
        (b"\n\n", "it is empty"),
        (b"hello\nworld\n", "line 1: "),
        (bytes(range(256)) * 10, "line 1: "),
        (b"[" * 1_000_000, "line 1: a frame of"),
        (b'{"t": 0, "skeleton": "nobody", "positions": []}', "unknown skeleton 'nobody'"),
    ],
)
def test_a_file_without_one_good_frame_is_refused_with_the_first_reason(tmp_path, content, message):
    path = tmp_path / "bad.jsonl"
    path.write_bytes(content)
    with pytest.raises(StudioError, match="holds no good frame") as e:
        load_frames(path)
    assert message in str(e.value)


def test_a_byte_order_mark_and_windows_line_ends_are_fine(tmp_path):
    path = tmp_path / "a.jsonl"
    text = "\r\n".join(json.dumps(object_of(p)) for p in poses(3))
    path.write_bytes(b"\xef\xbb\xbf" + text.encode())
    assert len(load_frames(path)[0]) == 3


def test_a_clip_of_any_rate_gives_its_newest_frame_within_half_a_period():
    t = 7.0 + np.arange(121) / 120
    clip = HumanClip(name="fast", t=t, joint_pos_w=np.tile(NEUTRAL, (121, 1, 1)),
                     confidence=np.ones((121, 19)))  # fmt: skip
    source = ClipSource(clip)
    assert source.duration == pytest.approx(121 / 120)
    given = [source.read(k / 30) for k in range(30)]
    for k, pose in enumerate(given):
        assert pose is not None
        # time counts from the clip's start; never newer than half a period ahead
        assert k / 30 <= pose.t + 1e-9 <= k / 30 + 1 / 60 + 2e-9
    with pytest.raises(SourceEnded):
        source.read(30 / 30)


@pytest.mark.parametrize("rate", [10, 24, 25, 30, 50, 60, 100, 120, 240])
def test_a_clip_of_any_rate_lasts_thirty_periods_a_second(rate):
    count = 4 * rate
    clip = HumanClip(name="clip", t=np.arange(count) / rate,
                     joint_pos_w=np.tile(NEUTRAL, (count, 1, 1)),
                     confidence=np.ones((count, 19)))  # fmt: skip
    read = list(source_poses(ClipSource(clip)))
    assert len(read) == 4 * 30
    assert sum(pose is not None for pose in read) == min(4 * 30, count)


def test_a_slow_clip_says_none_between_its_frames():
    slow = HumanClip(name="slow", t=np.arange(3) / 10, joint_pos_w=np.tile(NEUTRAL, (3, 1, 1)),
                     confidence=np.ones((3, 19)))  # fmt: skip
    source = ClipSource(slow)
    fresh = [source.read(k / 30) is not None for k in range(7)]
    assert fresh == [True, False, False, True, False, False, True]


def test_every_real_kinect_file_opens_with_no_line_refused(clips):
    files = sorted(clips.glob("*.jsonl"))
    assert files
    for file in files:
        source = open_source(f"frames:{file}")
        assert source.rejected == 0
        pose = source.read(0.0)
        assert pose is not None
        assert pose.joint_pos_w[INDEX["head"], 2] > pose.joint_pos_w[INDEX["pelvis"], 2] + 0.4


class Clock:
    def __init__(self) -> None:
        self.now = 50.0

    def __call__(self) -> float:
        return self.now


def test_a_stream_gives_the_newest_frame_once_and_says_how_old_it_is():
    clock = Clock()
    source = StreamSource(clock=clock)
    assert source.age == math.inf
    assert source.read(0.0) is None
    clock.now += 2.0
    source.push(frame(100.0))
    clock.now += 0.01
    source.push(json.dumps(frame(100.03, 0.1)))
    clock.now += 0.25
    assert source.age == pytest.approx(0.25)
    pose = source.read(0.0)
    assert pose is not None
    assert pose.joint_pos_w[0, 0] == pytest.approx(0.1)
    assert pose.t == pytest.approx(2.01)  # since it was opened, not the sender's clock
    assert source.read(0.0) is None


def test_a_bad_frame_never_reaches_the_reader_of_a_stream():
    source = StreamSource()
    source.push(frame(0.0))
    source.read(0.0)
    for bad in ("{}", b"\x00", frame(-1.0), {"t": 1}, "[" * 1_000_000, None):
        with pytest.raises(FrameRejected):
            source.push(bad)
    assert source.rejected == 6
    assert source.read(0.0) is None


def test_a_new_sender_may_use_another_clock_and_skeleton():
    clock = Clock()
    source = StreamSource(clock=clock)
    source.push(frame(1000.0))
    clock.now += 0.1
    with pytest.raises(FrameRejected):
        source.push(frame(0.0))
    source.new_sender()
    source.push(frame(0.0))
    assert source.rejected == 1


def test_a_stream_may_be_pushed_by_threads_while_the_loop_reads():
    clock = Clock()
    source = StreamSource(clock=clock)
    errors: list[BaseException] = []
    accepted = [0, 0]

    def push(which: int) -> None:
        for _ in range(200):
            clock.now += 0.05
            try:
                source.push(frame(clock.now))
                accepted[which] += 1
            except FrameRejected:
                pass  # the other thread was later
            except BaseException as e:
                errors.append(e)

    threads = [threading.Thread(target=push, args=(k,)) for k in range(2)]
    for thread in threads:
        thread.start()
    read = 0
    while any(thread.is_alive() for thread in threads):
        read += source.read(0.0) is not None
    read += source.read(0.0) is not None
    for thread in threads:
        thread.join()
    assert not errors
    assert 1 <= read <= sum(accepted)
    assert sum(accepted) + source.rejected == 400


def test_an_impaired_source_does_what_its_source_can_do():
    stream = Impaired(StreamSource(), Impairment())
    stream.push(frame(0.0))
    assert stream.read(0.1) is not None
    with pytest.raises(FrameRejected):
        stream.push({"t": 1.0})
    stream.new_sender()
    stream.push(frame(0.0))  # a clock of its own: not refused as older than what came before
    plain = InteractiveOperator(seed=1)
    operator = Impaired(InteractiveOperator(seed=1), Impairment())
    with pytest.raises(TakesNoFrames):
        operator.push(frame(0.0))
    for who in (plain, operator):
        who.set_intent(Intent(state="sit"))
    for k in range(60):
        asked, seen = plain.read(k / 30), operator.read(k / 30)
        assert asked is not None
        assert seen is not None
        np.testing.assert_array_equal(seen.joint_pos_w, asked.joint_pos_w)
    person = FollowingOperator(seed=1)
    follower = Impaired(person, Impairment())
    follower.set_style("circles")
    assert person.person.style == "circles"
    assert follower.read(0.0) is None
    follower.show(Intent(state="stand"))
    assert follower.read(1 / 30) is not None


def test_a_file_is_played_by_the_source_that_says_so():
    assert spec_of(Path("a/walk.BVH")) == "bvh:a/walk.BVH"
    assert spec_of(Path("a.json")) == "frames:a.json"
    with pytest.raises(StudioError, match=r"\.jsonl"):
        spec_of(Path("a.fbx"))
