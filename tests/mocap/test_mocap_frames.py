"""Recorded human frames in every form they come in, and what the report says of them."""

import json

import numpy as np
import pytest
from human_frames import object_of

from studio.errors import StudioError
from studio.human.pose import HumanPose
from studio.human.sensor_skeletons import SKELETONS
from studio.human.skeleton import INDEX, JOINTS, NEUTRAL
from studio.mocap.frames import read_frames
from studio.mocap.imports import import_human
from studio.sources import open_source
from studio.sources import poses as source_poses
from studio.takes.session_library import SessionLibrary

COUNT = 12


def poses() -> list[HumanPose]:
    return [
        HumanPose(t=k / 30, joint_pos_w=NEUTRAL + [0.02 * k, 0, 0], confidence=np.ones(19))
        for k in range(COUNT)
    ]


def objects() -> list[dict]:
    return [object_of(pose) for pose in poses()]


def lines(frames: list[dict]) -> str:
    return "\n".join(json.dumps(frame) for frame in frames) + "\n"


@pytest.fixture
def read(tmp_path):
    def read_back(content: str | bytes, name: str = "clip.jsonl"):
        path = tmp_path / name
        path.write_bytes(content.encode() if isinstance(content, str) else content)
        return read_frames(path)

    return read_back


FORMS = {
    "a frame a line": lambda frames: lines(frames),
    "an array": lambda frames: json.dumps(frames),
    "an array, indented": lambda frames: json.dumps(frames, indent=2),
    "an object with frames": lambda frames: json.dumps({"rate": 30, "frames": frames}),
    "an object with frames, indented": lambda f: json.dumps({"frames": f}, indent=1),
    "a frame a line, in UTF-16": lambda frames: lines(frames).encode("utf-16"),
    "an array, in UTF-16": lambda frames: json.dumps(frames).encode("utf-16"),
    "an array with a mark": lambda frames: b"\xef\xbb\xbf" + json.dumps(frames).encode(),
}


@pytest.mark.parametrize("form", sorted(FORMS))
def test_every_form_reads_the_same(read, form):
    recorded = read(FORMS[form](objects()))
    assert recorded.clip.t == pytest.approx(np.arange(COUNT) / 30)
    want = np.array([pose.joint_pos_w for pose in poses()])
    assert recorded.clip.joint_pos_w == pytest.approx(want)
    assert recorded.report.refused.frames == 0
    assert recorded.report.joints_missing == ()
    assert recorded.report.up_axis == "z"


@pytest.mark.parametrize("form", sorted(FORMS))
def test_a_bad_frame_is_counted_in_every_form(read, form):
    frames = objects()
    frames[3]["positions"] = frames[3]["positions"][:5]
    recorded = read(FORMS[form](frames))
    assert len(recorded.clip) == COUNT - 1
    assert recorded.report.refused.frames == 1
    why = recorded.report.refused.why[0]
    assert why.startswith(("frame 4: ", "line 4: "))
    assert "5 positions; skeleton studio has 19 joints" in why


def test_a_first_line_that_is_no_frame_does_not_make_the_others_a_document(read):
    recorded = read("garbage\n" + lines(objects()))
    assert len(recorded.clip) == COUNT
    assert recorded.report.refused.why[0].startswith("line 1: ")


@pytest.mark.parametrize("begun", [0.0, 1.7e9])
@pytest.mark.parametrize(
    ("unit", "name"),
    [(1e3, "milliseconds"), (1e6, "microseconds"), (1e9, "nanoseconds"), (1.0, None)],
)
@pytest.mark.parametrize("rate", [5, 30, 240])
def test_times_that_can_be_no_seconds_are_read_as_what_they_are(read, unit, name, begun, rate):
    frames = objects()
    for k, frame in enumerate(frames):
        frame["t"] = round((begun + k / rate) * unit, 4)
    recorded = read(lines(frames))
    # the epoch in ns has no better than 256 ns in a double; in s, as written, .1 ms
    assert np.diff(recorded.clip.t) == pytest.approx(np.full(COUNT - 1, 1 / rate), abs=1.1e-3)
    said = () if name is None else (f"t is in {name}: read as such",)
    assert recorded.report.notes == said


def test_one_frame_every_second_is_no_other_unit(read):
    frames = objects()
    for k, frame in enumerate(frames):
        frame["t"] = float(k)
    recorded = read(lines(frames))
    assert recorded.clip.t[-1] == COUNT - 1
    assert recorded.report.notes == ()


@pytest.mark.parametrize("nothing", ["null", "NaN"])
def test_a_joint_that_is_never_seen_is_missing_and_the_rest_drives(read, nothing):
    frames = objects()
    for frame in frames:
        frame["positions"][INDEX["head"]] = ["?"] * 3
    recorded = read(lines(frames).replace('"?"', nothing))
    assert recorded.report.refused.frames == 0
    assert recorded.report.joints_missing == ("head",)
    assert not recorded.clip.confidence[:, INDEX["head"]].any()
    assert recorded.clip.confidence[:, INDEX["l_wrist"]].all()


@pytest.mark.parametrize("far", [150.0, 30_000.0])
def test_the_place_is_counted_from_where_the_person_starts(read, far):
    frames = objects()
    for frame in frames:
        frame["positions"] = (np.array(frame["positions"]) + [far, -far, far]).tolist()
    recorded = read(lines(frames))
    want = np.array([pose.joint_pos_w for pose in poses()])
    want[..., 2] -= want[0, :, 2].min()  # so far up, the floor is where the first frame's feet are
    assert recorded.clip.joint_pos_w == pytest.approx(want, abs=1e-6)
    assert any("it begins at" in note for note in recorded.report.notes)


# Azure Kinect's offline processor ----------------------------------------------------------------


def kinect(bodies=lambda k, body: [body], **more) -> dict:
    source = SKELETONS["k4abt"]
    inverse = np.linalg.pinv(source.weights)
    frames = []
    for k, pose in enumerate(poses()):
        mm = 1000 * (inverse @ pose.joint_pos_w @ source.axes)
        body = {"body_id": 1, "joint_positions": mm.tolist(),
                "joint_orientations": [[1, 0, 0, 0]] * 32}  # fmt: skip
        seen = bodies(k, body)
        frames.append({"frame_id": k, "timestamp_usec": 500 + round(k * 1e6 / 30),
                       "num_bodies": len(seen), "bodies": seen})  # fmt: skip
    names = [n.upper() for n in source.joints]
    names = [n[:-1] + {"L": "LEFT", "R": "RIGHT"}[n[-1]] if n[-2:-1] == "_" else n for n in names]
    return {"joint_names": names, "bone_list": [], "frames": frames} | more


@pytest.mark.parametrize("indent", [None, 2])
def test_what_the_offline_processor_writes_is_read_in_metres_and_seconds(read, indent):
    recorded = read(json.dumps(kinect(), indent=indent), "clip.json")
    assert np.diff(recorded.clip.t) == pytest.approx(np.full(COUNT - 1, 1 / 30), abs=1e-6)
    want = np.array([pose.joint_pos_w for pose in poses()])
    assert recorded.clip.joint_pos_w == pytest.approx(want, abs=1e-6)
    assert (recorded.report.up_axis, recorded.report.scale_m) == ("-y", 0.001)
    assert recorded.report.joints_found["l_knee"] == ("knee_l",)


def test_of_two_bodies_the_one_seen_longest_is_the_person_and_absence_is_a_gap(read):
    def two(k, body):
        passer = {**body, "body_id": 7}
        return [passer, body] if k < 3 else [] if k in (5, 6) else [body]

    recorded = read(json.dumps(kinect(two)), "clip.json")
    present = [k for k in range(COUNT) if k not in (5, 6)]
    assert recorded.clip.t == pytest.approx(5e-4 + np.array(present) / 30, abs=1e-6)


def test_the_order_of_joint_names_is_kept_to(read):
    said = kinect()
    order = np.random.default_rng(0).permutation(32).tolist()
    said["joint_names"] = [said["joint_names"][k] for k in order]
    for frame in said["frames"]:
        (body,) = frame["bodies"]
        body["joint_positions"] = [body["joint_positions"][k] for k in order]
        body["joint_confidence"] = [[2] if k != 7 else [0] for k in order]  # 7: WRIST_LEFT
    recorded = read(json.dumps(said), "clip.json")
    want = np.array([pose.joint_pos_w for pose in poses()])
    assert recorded.clip.joint_pos_w == pytest.approx(want, abs=1e-6)
    assert recorded.report.joints_missing == ("l_wrist",)


def test_joints_of_another_sensor_are_refused_with_both_lists(read):
    said = kinect()
    said["joint_names"] = [*said["joint_names"][:-1], "TAIL"]
    with pytest.raises(StudioError, match=r"looked for pelvis, .*there is pelvis, .*tail"):
        read(json.dumps(said), "clip.json")


# Gaps --------------------------------------------------------------------------------------------


def with_gap(tmp_path):
    frames = objects()
    for frame in frames[6:]:
        frame["t"] += 3.0
    path = tmp_path / "gap.jsonl"
    path.write_text(lines(frames))
    return path


def test_a_source_gives_nothing_in_a_pause_and_lasts_as_long(tmp_path):
    source = open_source(f"frames:{with_gap(tmp_path)}")
    given = [pose is not None for pose in source_poses(source)]
    assert given == [True] * 6 + [False] * 90 + [True] * 6


def test_a_take_made_of_it_keeps_the_pause(tmp_path):
    (name,) = import_human(tmp_path, with_gap(tmp_path))["takes"]
    ticks = SessionLibrary(tmp_path).read(name).ticks
    assert len(ticks) == COUNT + 90
    assert [tick.human_fresh for tick in ticks] == [True] * 6 + [False] * 90 + [True] * 6
    source = open_source(f"take:{name}", sessions=tmp_path)
    read = [source.read(k / 30) for k in range(COUNT + 90)]
    assert [pose is not None for pose in read] == [tick.human_fresh for tick in ticks]


def test_what_is_read_differently_is_said_when_it_is_taken_in(tmp_path):
    frames = objects()
    for frame in frames:
        frame["t"] *= 1000
    path = tmp_path / "ms.jsonl"
    path.write_text(lines(frames))
    made = import_human(tmp_path, path)
    assert made["notes"] == ["t is in milliseconds: read as such"]
    assert len(SessionLibrary(tmp_path).read(made["takes"][0]).ticks) == COUNT


def test_a_skeleton_lists_its_canonical_joints_in_order():
    assert tuple(SKELETONS["studio"].found) == JOINTS
