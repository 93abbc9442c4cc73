"""The BVH reader: what is read, what is refused with the line number, and numbers by hand."""

import logging
import math
import tracemalloc
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from studio.errors import StudioError
from studio.human.skeleton import INDEX
from studio.mocap.bvh import load_bvh
from studio.mocap.bvh_header import read_hierarchy
from studio.mocap.bvh_motion import BLOCK
from studio.mocap.text import Lines

LEG = """JOINT {side}UpLeg {{
OFFSET {x} -5 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {side}Leg {{
OFFSET 0 -42 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {side}Foot {{
OFFSET 0 -43 0
CHANNELS 3 Zrotation Yrotation Xrotation
End Site {{
OFFSET 0 -4 14
}}
}}
}}
}}
"""
ARM = """JOINT {side}Arm {{
OFFSET {x} 50 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {side}ForeArm {{
OFFSET {x} 0 0
CHANNELS 3 Zrotation Yrotation Xrotation
JOINT {side}Hand {{
OFFSET {x} 0 0
CHANNELS 3 Zrotation Yrotation Xrotation
}}
}}
}}
"""
HEADER = (
    "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n"
    "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n"
    + LEG.format(side="Left", x=10)
    + LEG.format(side="Right", x=-10)
    + ARM.format(side="Left", x=25)
    + ARM.format(side="Right", x=-25)
    + "JOINT Head {\nOFFSET 0 65 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n"
    "End Site {\nOFFSET 0 20 0\n}\n}\n}\n"
)
CHANNELS = 6 + 13 * 3
STILL = " ".join(["0", "94", "0"] + ["0"] * (CHANNELS - 3))


def bvh(rows: list[str] | None = None, *, frames: int | None = None, header: str = HEADER) -> str:
    rows = [STILL] * 3 if rows is None else rows
    count = len(rows) if frames is None else frames
    return f"{header}MOTION\nFrames: {count}\nFrame Time: 0.0333333\n" + "\n".join(rows) + "\n"


@pytest.fixture
def load(tmp_path: Path):
    def load_text(text: str | bytes):
        path = tmp_path / "clip.bvh"
        path.write_bytes(text.encode() if isinstance(text, str) else text)
        return load_bvh(path)

    return load_text


def turned(**angles: tuple[int, float]) -> str:
    """The still row with some columns set: name=(column, value)."""
    row = STILL.split()
    for column, value in angles.values():
        row[column] = repr(value)
    return " ".join(row)


def test_a_standing_person_in_centimetres_by_hand(load):
    clip = load(bvh())
    assert len(clip) == 3
    assert clip.t == pytest.approx([0.0, 0.0333333, 0.0666666])
    p = clip.joint_pos_w[0]
    # hips .94 m up; hip joint .05 below; y of the file is up, x is left, z is forward
    assert p[INDEX["l_hip"]] == pytest.approx([0.0, 0.10, 0.89])
    assert p[INDEX["pelvis"]] == pytest.approx([0.0, 0.0, 0.89])
    assert p[INDEX["l_ankle"]] == pytest.approx([0.0, 0.10, 0.04])
    assert p[INDEX["l_toe"]] == pytest.approx([0.14, 0.10, 0.0])  # the foot's end site
    assert p[INDEX["r_wrist"]] == pytest.approx([0.0, -0.75, 1.44])
    assert p[INDEX["head"]] == pytest.approx([0.0, 0.0, 1.69])  # half way to its end site
    assert (clip.confidence == 1.0).all()


def test_rotations_apply_in_the_order_of_the_channels_by_hand(load):
    # left hip: Z by 90 then, about the turned axes, X by 90: R = Rz Rx. The thigh (0, -42, 0)
    # goes by Rx(90) to (0, 0, -42) and Rz(90) leaves z: file z is forward, so 42 cm backward.
    clip = load(bvh([turned(z=(6, 90.0), x=(8, 90.0))]))
    p = clip.joint_pos_w[0]
    assert p[INDEX["l_knee"]] - p[INDEX["l_hip"]] == pytest.approx([-0.42, 0.0, 0.0], abs=1e-9)
    # the other order, Rx Rz: (0, -42, 0) by Rz(90) to (42, 0, 0), which Rx leaves: to the left
    header = HEADER.replace(
        "OFFSET 10 -5 0\nCHANNELS 3 Zrotation Yrotation Xrotation",
        "OFFSET 10 -5 0\nCHANNELS 3 Xrotation Yrotation Zrotation",
    )
    p = load(bvh([turned(x=(6, 90.0), z=(8, 90.0))], header=header)).joint_pos_w[0]
    assert p[INDEX["l_knee"]] - p[INDEX["l_hip"]] == pytest.approx([0.0, 0.42, 0.0], abs=1e-9)


def test_six_channel_joints_replace_their_offset(load):
    header = HEADER.replace(
        "OFFSET 10 -5 0\nCHANNELS 3 Z",
        "OFFSET 10 -5 0\nCHANNELS 6 Xposition Yposition Zposition Z",
    )
    row = STILL.split()
    row[6:6] = ["12", "-7", "3"]
    p = load(bvh([" ".join(row)], header=header)).joint_pos_w[0]
    assert p[INDEX["l_hip"]] - p[INDEX["r_hip"]] == pytest.approx([0.03, 0.22, -0.02])


@pytest.mark.parametrize(
    ("scale", "leg"),
    [(1.0, 0.85), (0.01, 0.85), (10.0, 0.85), (1 / 2.54, 0.85), (1 / 5.6444, 0.85), (3.7, 0.85)],
)
def test_scale_is_found_from_the_legs(load, scale, leg):
    lines = []
    for line in HEADER.splitlines():
        if line.startswith("OFFSET"):
            line = "OFFSET " + " ".join(str(float(v) * scale) for v in line.split()[1:])
        lines.append(line)
    row = STILL.replace("94", str(94 * scale))
    p = load(bvh([row], header="\n".join(lines) + "\n")).joint_pos_w[0]
    length = np.linalg.norm(p[INDEX["l_knee"]] - p[INDEX["l_hip"]]) + np.linalg.norm(
        p[INDEX["l_ankle"]] - p[INDEX["l_knee"]]
    )
    assert length == pytest.approx(leg, rel=1e-4)
    assert p[INDEX["pelvis"], 2] == pytest.approx(0.89, rel=1e-4)


def test_a_child_in_centimetres_keeps_its_size(load):
    header = HEADER.replace("-42", "-32").replace("-43", "-33")
    p = load(bvh(header=header)).joint_pos_w[0]
    assert p[INDEX["l_hip"], 2] - p[INDEX["l_ankle"], 2] == pytest.approx(0.65)


def test_z_up_files_stand_up_too(load):
    # the same body lying along the file's z: (x, y, z) -> (z, x, y)
    lines = []
    for line in HEADER.splitlines():
        if line.startswith("OFFSET"):
            x, y, z = line.split()[1:]
            line = f"OFFSET {z} {x} {y}"
        lines.append(line)
    row = " ".join(["0", "0", "94"] + ["0"] * (CHANNELS - 3))
    p = load(bvh([row], header="\n".join(lines) + "\n")).joint_pos_w[0]
    assert p[INDEX["l_hip"]] == pytest.approx([0.0, 0.10, 0.89])
    assert p[INDEX["l_toe"]] == pytest.approx([0.14, 0.10, 0.0])


ODD = {
    "byte-order mark": lambda s: "\ufeff" + s,
    "windows line ends": lambda s: s.replace("\n", "\r\n"),
    "old mac line ends": lambda s: s.replace("\n", "\r"),
    "tabs": lambda s: s.replace(" ", "\t"),
    "indented with trailing blanks": lambda s: s.replace("\n", "   \n\t  "),
    "blank lines": lambda s: s.replace("\n", "\n\n"),
    "lower case": lambda s: s.replace("HIERARCHY", "hierarchy").replace("ROOT", "root").replace(
        "JOINT", "joint").replace("OFFSET", "offset").replace("CHANNELS", "channels").replace(
        "Zrotation", "zrotation").replace("MOTION", "motion").replace("End Site", "end site"
        ).replace("Frames", "frames").replace("Frame Time", "frame time"),
    "upper case": lambda s: s.replace("rotation", "ROTATION").replace("End Site", "END SITE"),
    "frame time without a blank": lambda s: s.replace("Time: ", "Time:"),
    "frames without a blank": lambda s: s.replace("Frames: ", "Frames:"),
    "frame time with blanks before the colon": lambda s: s.replace("Time:", "Time :"),
    "brace glued to the name": lambda s: s.replace(" {", "{"),
    "brace on its own line": lambda s: s.replace(" {", "\n{"),
    "joint on one line": lambda s: s.replace("{\nOFFSET", "{ OFFSET"),
    "exponents": lambda s: s.replace("94", "9.4E+01").replace("-42", "-4.2e1"),
    "no final line end": lambda s: s.rstrip(),
    "name with a prefix": lambda s: s.replace("JOINT ", "JOINT mixamorig:"),
    "latin-1 in a name": lambda s: s.replace("ROOT Hips", "ROOT H\u00fcfte").encode("latin-1"),
}  # fmt: skip


@pytest.mark.parametrize("odd", sorted(ODD))
def test_odd_but_honest_files_read_the_same(load, odd):
    plain = load(bvh())
    other = load(ODD[odd](bvh()))
    assert (other.joint_pos_w == plain.joint_pos_w).all()
    assert other.t == pytest.approx(plain.t)


def test_a_missing_end_site_leaves_the_toe_unseen_and_the_rest_read(load):
    header = HEADER.replace("End Site {\nOFFSET 0 -4 14\n}\n", "")
    clip = load(bvh(header=header))
    assert clip.confidence[0, INDEX["l_toe"]] == 0.0
    assert clip.confidence[0, INDEX["l_ankle"]] == 1.0


@pytest.mark.parametrize("claimed", [0, 1, 7, 10**9])
def test_a_header_that_lies_about_its_frames_is_read_and_logged(load, claimed, caplog):
    with caplog.at_level(logging.WARNING):
        assert len(load(bvh(frames=claimed))) == 3
    assert f"claims {claimed} frames, has 3" in caplog.text


def test_a_last_row_cut_by_the_end_of_the_file_is_left_out(load, caplog):
    text = bvh() + " ".join(STILL.split()[:20])
    with caplog.at_level(logging.WARNING):
        assert len(load(text)) == 3
    assert "cut short" in caplog.text


def line_of(text: str, part: str) -> int:
    return text[: text.index(part)].count("\n") + 1


BAD = {
    "empty": ("", 0, "the file ends"),
    "something else": ("%PDF-1.7 not a bvh\n", 1, "begins with HIERARCHY"),
    "binary": (bytes(range(256)) * 40, 1, "begins with HIERARCHY"),
    "no frames": (bvh([]), None, "no frames"),
    "nan": (bvh([STILL.replace("94", "NaN")] * 3), None, "'NaN' is not finite"),
    "infinite": (bvh([STILL.replace("94", "-inf")]), None, "not finite"),
    "overflowing": (bvh([STILL.replace("94", "1e999")]), None, "not finite"),
    "huge": (bvh([STILL.replace("94", "1e300")]), None, "no position and no angle"),
    "a word": (bvh([STILL.replace("94", "ninety")]), None, "'ninety' is no number"),
    "a short row": (bvh([STILL, "0 94 0", STILL]), None, "3 values"),
    "a long row": (bvh([STILL, STILL + " 1"]), None, "46 values"),
    "frame time zero": (bvh().replace("0.0333333", "0"), None, "Frame Time: 0 s"),
    "frame time nan": (bvh().replace("0.0333333", "nan"), None, "not finite"),
    "frame time negative": (bvh().replace("0.0333333", "-.03"), None, "Frame Time"),
    "no frame time": (bvh().replace("Frame Time: 0.0333333\n", ""), None, "Frame Time: SECONDS"),
    "frames half": (bvh().replace("Frames: 3", "Frames: 3.5"), None, "no count"),
    "no motion": (HEADER, None, "the file ends"),
    "header cut": (HEADER[: HEADER.index("JOINT LeftLeg")], None, "the file ends"),
    "brace missing": (bvh(header=HEADER[:-2]), None, "'MOTION' is not expected here, inside Hips"),
    "brace too many": (bvh(header=HEADER + "}\n"), None, "'}' is not expected"),
    "two offsets": (
        bvh(header=HEADER.replace("OFFSET 0 0 0", "OFFSET 0 0 0 " * 2)), 4, "once per joint"),
    "no root": (bvh(header=HEADER.replace("ROOT", "JOINT")), 2, "where ROOT NAME should come"),
    "two roots": (bvh(header=HEADER + "ROOT Other\n{\n"), None, "'ROOT' is not expected"),
    "offset short": (bvh(header=HEADER.replace("OFFSET 0 0 0", "OFFSET 0 0")), 5, "no number"),
    "bad channel": (bvh(header=HEADER.replace("Xposition", "Xshear")), 5, "'xshear' is no channel"),
    "seven channels": (bvh(header=HEADER.replace("CHANNELS 6", "CHANNELS 7")), 6, "is no channel"),
    "ten channels": (bvh(header=HEADER.replace("CHANNELS 6", "CHANNELS 10")), 5, "CHANNELS 10"),
    "channels huge": (bvh(header=HEADER.replace("CHANNELS 6", "CHANNELS 1e9")), 5, "CHANNELS"),
    "no legs": (bvh(header=HEADER.replace("LeftLeg", "Tail")), None, "no joint for l_knee"),
    "legs of no length": (
        bvh(header=HEADER.replace("-42", "0").replace("-43", "0")), None, "legs of length 0"),
    "a very long line": (bvh([STILL + " 0" * 200_000]), None, "longer than"),
    "no line end at all": ("HIERARCHY " + "ROOT " * 100_000, 1, "longer than"),
    "deeper than any body": (
        "HIERARCHY\nROOT a\n{\n" + "JOINT b\n{\n" * 3000, None, "more than 1000 joints"),
}  # fmt: skip


@pytest.mark.parametrize("what", sorted(BAD))
def test_a_bad_file_is_refused_with_the_line(load, what):
    text, line, message = BAD[what]
    with pytest.raises(StudioError, match=r"clip\.bvh, line \d+: ") as e:
        load(text)
    assert message in str(e.value)
    if line is not None:
        assert f"line {line}: " in str(e.value)


def test_the_line_of_a_bad_value_is_the_one_an_editor_shows(load):
    text = bvh([STILL, STILL, "0 94 0", STILL])
    with pytest.raises(StudioError, match=f"line {line_of(text, '0 94 0' + chr(10))}:"):
        load(text.replace("\n", "\r\n"))


@pytest.mark.parametrize("path", ["nowhere.bvh", "", ".", "a\0b"])
def test_what_is_no_file_is_refused(path, tmp_path):
    with pytest.raises(StudioError, match="cannot read"):
        load_bvh(tmp_path / path if path else tmp_path)


@settings(
    max_examples=100, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture]
)
@given(st.data())
def test_a_damaged_file_is_read_or_refused_and_nothing_else(load, data):
    text = bvh()
    at = data.draw(st.integers(0, len(text)))
    cut = data.draw(st.integers(0, 40))
    junk = data.draw(st.text(alphabet="{}\n\t 0-9.eE+naifJOINT:\0\u2028", max_size=12))
    try:
        clip = load(text[:at] + junk + text[at + cut :])
    except StudioError:
        return
    assert np.isfinite(clip.joint_pos_w).all()


def test_a_header_of_one_long_line_is_read(load):
    finger = "JOINT LeftHandFinger%d { OFFSET 0 0 1 CHANNELS 0 } "
    fingers = "".join(finger % k for k in range(900))
    words = " ".join(HEADER.split()).replace("JOINT Head", fingers + "JOINT Head")
    assert (load(bvh(header=words + "\n")).joint_pos_w == load(bvh()).joint_pos_w).all()


def test_memory_is_that_of_the_canonical_joints_not_of_the_file(load):
    n = 6 * BLOCK
    text = bvh([STILL] * n)
    tracemalloc.start()
    clip = load(text)
    peak = tracemalloc.get_traced_memory()[1]
    tracemalloc.stop()
    assert len(clip) == n
    # 608 B a frame are kept, twice while the blocks are joined; a block's own tables come on top
    assert peak < 2 * 620 * n + 6e6


def test_every_real_clip_reads_in_metres(clips):
    files = sorted(clips.glob("*.bvh"))
    assert files
    for file in files:
        clip = load_bvh(file)
        p = clip.joint_pos_w
        leg = np.linalg.norm(p[0, INDEX["l_knee"]] - p[0, INDEX["l_hip"]]) + np.linalg.norm(
            p[0, INDEX["l_ankle"]] - p[0, INDEX["l_knee"]]
        )
        assert 0.75 < leg < 0.95, file.name
        assert (clip.confidence == 1.0).all(), file.name
        feet = p[:, [INDEX["l_toe"], INDEX["r_toe"]], 2].min()
        assert -0.1 < feet < 0.12, file.name
        assert 1 / (clip.t[1] - clip.t[0]) == pytest.approx(120 if "131" in file.name else 60, 1e-3)


@pytest.mark.slow  # pymotion takes seconds to import
def test_forward_kinematics_agree_with_an_independent_reader(clips):
    from pymotion.io.bvh import BVH
    from pymotion.ops.skeleton import fk

    file = clips / "cmu_13_29_squats.bvh"
    if not file.exists():
        pytest.skip(f"{file.name} is not among the clips")
    other = BVH()
    other.load(str(file))
    rotations, root, parents, offsets, _, _ = other.get_data()
    theirs, _ = fk(rotations, root[:, 0], offsets, parents)
    names = [str(name) for name in other.data["names"]]
    with file.open() as text:
        hierarchy = read_hierarchy(Lines(text, file.name))
        motion = np.array([line.split() for line in text.readlines()[2:] if line.strip()], float)
    ours = hierarchy.joint_pos(motion)
    shared = [n for n in names if n in hierarchy.names and not n.endswith("/end")]
    assert len(shared) >= 25
    for name in shared:
        ours_k, theirs_k = hierarchy.names.index(name), names.index(name)
        assert ours[:, ours_k] == pytest.approx(theirs[:, theirs_k], abs=2e-3), name  # cm


def test_math_is_right_about_the_cmu_unit():
    # CMU's unit: an inch over .45
    assert math.isclose(2.54 / 0.45, 5.6444, rel_tol=1e-5)
