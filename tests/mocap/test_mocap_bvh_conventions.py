"""Files as every studio, game and library writes them: the same person is found in each."""

from dataclasses import replace

import numpy as np
import pytest
from bvh_writer import BODY, NAMES, Y_UP, Layout, Names, joints, write

from studio.errors import StudioError
from studio.human.joint_names import MAPPABLE, UnmappedJoints
from studio.human.skeleton import INDEX
from studio.mocap.bvh import read_bvh

MAPPED = [joint for joint in MAPPABLE if joint in BODY]
TRAVELLING = Layout(travel=1.2)


@pytest.fixture
def read(tmp_path):
    """Writes a layout (or text) to a file and reads it."""

    def read_back(layout: Layout | str | bytes, **options):
        path = tmp_path / "clip.bvh"
        text = write(layout) if isinstance(layout, Layout) else layout
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return read_bvh(path, **options)

    return read_back


def assert_found(recorded, layout: Layout, first: int = 0, turned: bool = False) -> None:
    """Every joint is where the writer put it (to 0.1 mm), counted from where the person starts.

    turned: which way the person faces in the file is open: both are turned to face +x at first.
    """
    truth = {role: pos[first:] for role, pos in joints(layout).items()}
    middle = 0.5 * (truth["l_hip"][0] + truth["r_hip"][0]) * [1.0, 1.0, 0.0]
    across = truth["l_hip"][0] - truth["r_hip"][0]
    assert len(recorded.clip) == len(truth["hips"])
    found = {j: recorded.clip.joint_pos_w[:, INDEX[j]] for j in MAPPED}
    back = about_up(across) if turned else np.eye(3)
    own = about_up(found["l_hip"][0] - found["r_hip"][0]) if turned else np.eye(3)
    for joint in MAPPED:
        assert found[joint] @ own.T == pytest.approx((truth[joint] - middle) @ back.T, abs=1e-4), (
            joint
        )
    assert recorded.report.joints_missing == ()


def about_up(across: np.ndarray) -> np.ndarray:
    """The turn about z that lays a line from right to left along +y."""
    a = np.arctan2(across[0], across[1])
    return np.array([[np.cos(a), -np.sin(a), 0], [np.sin(a), np.cos(a), 0], [0, 0, 1]])


@pytest.mark.parametrize("convention", sorted(NAMES))
def test_each_convention_of_names_is_understood(read, convention):
    layout = replace(TRAVELLING, names=NAMES[convention])
    recorded = read(layout)
    assert_found(recorded, layout)
    found = recorded.report.joints_found
    for role in BODY:
        if role in MAPPED:
            assert found[role][0] == layout.names.of(role).partition(">")[0]
    assert recorded.report.scale_m == 0.01
    assert recorded.report.up_axis == "y"
    assert recorded.report.refused.frames == 0


@pytest.mark.parametrize("convention", ["MotionBuilder", "Bandai Namco", "MMD"])
@pytest.mark.parametrize("offsets", ["rest", "zero"])
def test_positions_on_every_joint_give_the_same_motion(read, convention, offsets):
    layout = replace(TRAVELLING, names=NAMES[convention], channels="all", offsets=offsets)
    assert_found(read(layout), layout)


def test_positions_that_are_displacements_are_added_to_the_offsets(read):
    layout = replace(TRAVELLING, channels="all", added=True)
    recorded = read(layout)
    assert_found(recorded, layout)
    assert "positions of joints are added to their OFFSETs" in recorded.report.notes


@pytest.mark.parametrize("offsets", ["rest", "zero"])
@pytest.mark.parametrize("unit", [1.0, 100.0, 1000.0, 1 / 0.0254])
def test_the_scale_is_found_from_offsets_or_else_from_positions(read, unit, offsets):
    layout = replace(TRAVELLING, unit=unit, channels="all", offsets=offsets)
    recorded = read(layout)
    assert recorded.report.scale_m == pytest.approx(1 / unit)
    assert_found(recorded, layout)


def test_offsets_of_another_unit_than_the_positions_are_not_believed(read):
    text = write(replace(TRAVELLING, channels="all"))
    header, motion = text.split("MOTION")
    lines = [
        "OFFSET " + " ".join(str(float(v) / 100) for v in line.split()[1:])
        if line.startswith("OFFSET")
        else line
        for line in header.splitlines()
    ]
    recorded = read("\n".join(lines) + "\nMOTION" + motion)
    assert recorded.report.scale_m == 0.01
    knee, ankle = (recorded.clip.joint_pos_w[0, INDEX[j]] for j in ("l_knee", "l_ankle"))
    assert np.linalg.norm(knee - ankle) == pytest.approx(0.42, abs=1e-4)


# file vector = rows @ (forward, left, up): proper turns, the person facing any of the other axes
UP = {
    "y": [[0, 1, 0], [0, 0, 1], [1, 0, 0]],
    "-y": [[0, 1, 0], [0, 0, -1], [-1, 0, 0]],
    "z": [[0, -1, 0], [1, 0, 0], [0, 0, 1]],
    "-z": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],
    "x": [[0, 0, 1], [1, 0, 0], [0, 1, 0]],
    "-x": [[0, 0, -1], [0, 1, 0], [1, 0, 0]],
}


@pytest.mark.parametrize("offsets", ["rest", "zero"])
@pytest.mark.parametrize("up", sorted(UP))
def test_up_is_found_along_any_axis_and_either_sign(read, up, offsets):
    axes = np.array(UP[up], dtype=float)
    assert np.linalg.det(axes) == pytest.approx(1.0)
    layout = replace(TRAVELLING, axes=axes, channels="all", offsets=offsets)
    recorded = read(layout)
    assert recorded.report.up_axis == up
    assert_found(recorded, layout, turned=True)


@pytest.mark.parametrize("up", sorted(UP))
def test_a_left_handed_world_is_told_by_its_feet(read, up):
    axes = np.array(UP[up], dtype=float) @ np.diag([1.0, -1.0, 1.0])
    layout = replace(TRAVELLING, axes=axes)
    recorded = read(layout)
    assert recorded.report.up_axis == up
    assert "a left-handed world: left and right were swapped" in recorded.report.notes
    assert_found(recorded, layout, turned=True)


def test_somebody_who_lies_down_throughout_is_not_stood_up_where_the_rest_pose_stands(read):
    # lying on the side, head along the file's x: a turn of the root, in a y-up world
    lines = write(Layout()).splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    for k in range(first, len(lines)):
        row = lines[k].split()
        row[3:6] = ["90", "0", "0"]
        lines[k] = " ".join(row)
    recorded = read("\n".join(lines))
    assert recorded.report.up_axis == "y"
    chest, pelvis = (recorded.clip.joint_pos_w[0, INDEX[j]] for j in ("chest", "pelvis"))
    assert abs(chest[2] - pelvis[2]) < 0.01


@pytest.mark.parametrize("fps", [24, 25, 30, 50, 60, 100, 120, 240])
def test_any_rate_from_24_to_240_is_kept(read, fps):
    layout = replace(TRAVELLING, fps=fps)
    recorded = read(layout)
    assert_found(recorded, layout)
    assert recorded.clip.t == pytest.approx(np.arange(2 * fps) / fps, abs=1e-4)


@pytest.mark.parametrize("fps", [24, 30, 120])
@pytest.mark.parametrize("start", [(0.0, 0.0, 0.93), (3.0, -2.0, 0.93), (150.0, 0.0, 0.93)])
def test_a_rest_pose_for_a_first_frame_is_left_out_and_said(read, fps, start):
    layout = replace(TRAVELLING, fps=fps, start=start, t_pose_first=True)
    recorded = read(layout)
    assert_found(recorded, layout, first=1)
    assert recorded.report.refused.frames == 1
    assert "rest pose" in recorded.report.refused.why[0]


def test_a_first_frame_that_the_motion_goes_on_from_is_kept(read):
    assert read(TRAVELLING).report.refused.frames == 0


def test_the_place_is_counted_from_where_the_person_starts(read):
    layout = replace(TRAVELLING, start=(15_000.0, -3_000.0, 500.0), unit=1.0)
    recorded = read(layout)
    pelvis = recorded.clip.joint_pos_w[:, INDEX["pelvis"]]
    assert pelvis[0, :2] == pytest.approx([0.0, 0.0], abs=1e-6)
    assert 0.8 < pelvis[0, 2] < 1.1
    assert pelvis[-1, 0] == pytest.approx(1.2 * 59 / 30, abs=1e-3)
    assert any("it begins at" in note for note in recorded.report.notes)


TEXT = {
    "decimal commas": lambda s: s.replace(".", ","),
    "commas between": lambda s: "\n".join(
        line if "JOINT" in line or "ROOT" in line else line.replace(" ", ", ").replace(
            "OFFSET,", "OFFSET").replace("CHANNELS,", "CHANNELS").replace("End,", "End").replace(
            "Time:,", "Time:").replace("Frame,", "Frame").replace("Frames:,", "Frames:")
        for line in s.splitlines()),
    "UTF-16": lambda s: s.encode("utf-16"),
    "UTF-16, big end first": lambda s: b"\xfe\xff" + s.encode("utf-16-be"),
    "UTF-16 without a mark": lambda s: s.encode("utf-16-le"),
    "UTF-16, big end first, without a mark": lambda s: s.encode("utf-16-be"),
    "rows wrapped": lambda s: _wrapped(s, 12),
    "rows wrapped, a value a line": lambda s: _wrapped(s, 1),
    "named end sites": lambda s: s.replace("End Site", "End Site Nub 1"),
    "end sites by name only": lambda s: s.replace("End Site", "End Nub"),
    "all in one line but the rows": lambda s: " ".join(s.split("MOTION")[0].split())
    + "\nMOTION" + s.split("MOTION")[1],
}  # fmt: skip


def _wrapped(text: str, values: int) -> str:
    lines = text.splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    out = lines[:first]
    for line in lines[first:]:
        row = line.split()
        out += [" ".join(row[k : k + values]) for k in range(0, len(row), values)]
    return "\n".join(out)


@pytest.mark.parametrize("how", sorted(TEXT))
def test_every_way_of_writing_numbers_reads_the_same(read, how):
    text = TEXT[how](write(TRAVELLING))
    assert_found(read(text), TRAVELLING)


@pytest.mark.parametrize("encoding", ["utf-8", "cp932", "utf-16"])
def test_names_in_japanese_are_read_in_the_encodings_they_come_in(read, encoding):
    layout = replace(TRAVELLING, names=NAMES["MMD"])
    assert_found(read(write(layout).encode(encoding)), layout)


def test_channels_of_scale_are_read_past(read):
    layout = replace(TRAVELLING, scales=True, channels="all")
    assert_found(read(layout), layout)


@pytest.mark.parametrize("bad", ["nan", "-NaN(ind)", "1.#QNAN", "inf", "1e300", "?"])
def test_a_frame_with_what_is_no_number_is_left_out_and_counted(read, bad):
    lines = write(TRAVELLING).splitlines()
    first = next(k for k, line in enumerate(lines) if line.startswith("Frame Time")) + 1
    for k in (first + 7, first + 30):
        lines[k] = lines[k].replace(lines[k].split()[4], bad, 1)
    recorded = read("\n".join(lines))
    kept = np.delete(np.arange(60), [7, 30])
    assert recorded.clip.t == pytest.approx(kept / 30, abs=1e-5)
    assert recorded.report.refused.frames == 2
    assert f"line {first + 8}: " in recorded.report.refused.why[0]
    assert recorded.clip.joint_pos_w[8, INDEX["l_knee"]] == pytest.approx(
        read(TRAVELLING).clip.joint_pos_w[9, INDEX["l_knee"]]
    )


def test_what_cannot_be_mapped_is_refused_with_what_was_sought_and_what_there_is(read):
    names = Names(leg=("{}Gamba", "{}Polpaccio", "{}Foot", "{}Toe"))
    with pytest.raises(UnmappedJoints) as e:
        read(Layout(names=names))
    said = str(e.value)
    assert isinstance(e.value, StudioError)
    for part in (
        "no joint for l_hip, r_hip, l_knee, r_knee",
        "looked for LeftUpleg, LeftUpperleg",
        "LeftGamba, LeftPolpaccio",
        '{"l_hip": "NAME", …}',
        "clip.bvh, line ",
    ):
        assert part in said
    assert "\n" not in said


def test_a_collar_bone_is_no_shoulder_where_there_is_an_arm(read):
    recorded = read(Layout(names=NAMES["OptiTrack"]))
    assert recorded.report.joints_found["r_shoulder"] == ("RUArm",)
    assert recorded.report.joints_found["r_elbow"] == ("RFArm",)


def test_what_is_not_there_is_said_to_be_missing(read):
    names = Names(arm=("{}Shoulder", "{}Arm", "{}Tentacle", "{}Sucker"))
    report = read(Layout(names=names)).report
    assert report.joints_missing == ("l_elbow", "l_wrist", "r_elbow", "r_wrist")
    assert report.as_dict()["joints_missing"] == list(report.joints_missing)


def test_our_own_axes_are_what_the_writer_says():
    # left of a y-up file is its x, up its y, forward its z
    assert (Y_UP @ [0.0, 1.0, 0.0] == [1.0, 0.0, 0.0]).all()
    assert (Y_UP @ [0.0, 0.0, 1.0] == [0.0, 1.0, 0.0]).all()
