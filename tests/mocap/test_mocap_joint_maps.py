"""A joint map said by hand: what it may say, what it changes, and that it is remembered."""

import json

import pytest
from bvh_writer import Layout, Names, write

from studio.errors import StudioError
from studio.human.joint_names import MAPPABLE, UnmappedJoints
from studio.mocap.imports import import_take
from studio.mocap.joint_maps import FOLDER, JointMaps, joint_map_of, read_joint_map
from studio.sources import open_source
from studio.takes.session_library import SessionLibrary

ITALIAN = Names(
    left="SX", right="DX",
    arm=("clavicola{}", "spalla{}", "gomito{}", "polso{}"),
    leg=("anca{}", "ginocchio{}", "caviglia{}", "punta{}"),
)  # fmt: skip
SAID = {
    f"{side}_{joint}": own + word
    for side, word in (("l", "SX"), ("r", "DX"))
    for joint, own in (
        ("shoulder", "spalla"), ("elbow", "gomito"), ("wrist", "polso"),
        ("hip", "anca"), ("knee", "ginocchio"), ("ankle", "caviglia"), ("toe", "punta"),
    )
}  # fmt: skip


@pytest.fixture
def clip(tmp_path):
    path = tmp_path / "italian.bvh"
    path.write_text(write(Layout(names=ITALIAN)))
    return path


def test_unknown_names_are_read_by_a_map_and_then_by_what_was_remembered(clip, tmp_path):
    sessions, other = tmp_path / "sessions", tmp_path / "other.bvh"
    with pytest.raises(UnmappedJoints):
        open_source(f"bvh:{clip}", sessions=sessions)
    source = open_source(f"bvh:{clip}", sessions=sessions, joint_map=joint_map_of(SAID))
    report = source.report
    assert report.joints_missing == ()
    assert report.joints_found["l_knee"] == ("ginocchioSX",)
    assert report.notes[0].startswith("by a joint map: ")
    # another file of the same joints, longer and in metres
    other.write_text(write(Layout(names=ITALIAN, seconds=3.0, unit=1.0)))
    assert open_source(f"bvh:{other}", sessions=sessions).report.joints_missing == ()
    assert import_take(sessions, other)["takes"]
    with pytest.raises(UnmappedJoints):
        open_source(f"bvh:{other}", sessions=tmp_path / "elsewhere")


def test_a_map_that_did_not_work_is_not_remembered(clip, tmp_path):
    half = {j: n for j, n in SAID.items() if "ankle" not in j}
    with pytest.raises(UnmappedJoints, match="no joint for l_ankle, r_ankle"):
        open_source(f"bvh:{clip}", sessions=tmp_path, joint_map=joint_map_of(half))
    assert not (tmp_path / FOLDER).exists()


def test_a_map_goes_before_the_names_and_null_takes_away(tmp_path):
    path = tmp_path / "a.bvh"
    path.write_text(write(Layout()))
    said = joint_map_of({"l_wrist": "LeftForeArm", "l_elbow": None, "head": ["Neck", "Head"]})
    report = open_source(f"bvh:{path}", sessions=tmp_path, joint_map=said).report
    assert report.joints_found["l_wrist"] == ("LeftForeArm",)
    assert report.joints_found["head"] == ("Neck", "Head")
    assert report.joints_found["r_wrist"] == ("RightHand",)
    assert report.joints_missing == ("l_elbow",)


@pytest.mark.parametrize(
    ("said", "message"),
    [
        ({"l_tail": "Tail"}, "no joint 'l_tail'; known: l_hip"),
        ({"pelvis": "Hips"}, "no joint 'pelvis'"),
        ({"l_hip": "Hippo"}, "l_hip is said to be 'Hippo'; there is Hips, Spine"),
        ({"l_hip": 3}, "a joint map is"),
        ({"l_hip": {"a": 1}}, "a joint map is"),
        (["l_hip"], "a joint map is"),
        ("l_hip", "a joint map is"),
        (None, "a joint map is"),
    ],
)
def test_a_map_that_does_not_fit_is_refused_saying_what_would(tmp_path, said, message):
    path = tmp_path / "a.bvh"
    path.write_text(write(Layout()))
    with pytest.raises(StudioError, match=message):
        open_source(f"bvh:{path}", sessions=tmp_path, joint_map=joint_map_of(said))


def test_a_map_is_read_from_json_and_nothing_else(tmp_path):
    path = tmp_path / "map.json"
    path.write_text(json.dumps(SAID))
    assert read_joint_map(path) == {joint: [name] for joint, name in SAID.items()}
    for bad in ("", "{", "[" * 100_000, "hello"):
        path.write_text(bad)
        with pytest.raises(StudioError, match=r"map\.json: .*a joint map is"):
            read_joint_map(path)
    with pytest.raises(StudioError, match="cannot read"):
        read_joint_map(tmp_path / "nowhere.json")


@pytest.mark.parametrize("spec", ["operator", "frames:x.jsonl", "take:x", "stream"])
def test_a_source_whose_joints_are_known_takes_no_map(spec):
    with pytest.raises(StudioError, match="takes no joint map"):
        open_source(spec, joint_map={})


def test_maps_are_kept_by_the_set_of_names_and_forgotten_when_empty(tmp_path):
    maps = JointMaps(tmp_path)
    maps.remember(["a", "b", "b/end"], {"l_hip": ["a"]})
    assert maps.of(["b", "a"]) == {"l_hip": ["a"]}
    maps.remember(["a", "b", "b/end"], {"l_hip": ["a"], "head": ["b", "b/end"], "l_toe": []})
    assert maps.of(["b", "a"]) == {"l_hip": ["a"], "l_toe": []}
    assert maps.of(["a", "b", "c"]) is None
    maps.remember(["a", "b"], {})
    assert maps.of(["a", "b"]) is None
    maps.remember(["a", "b"], {})


def test_a_damaged_map_is_left_out(tmp_path, caplog):
    maps = JointMaps(tmp_path)
    maps.remember(["a"], {"l_hip": ["a"]})
    (file,) = (tmp_path / FOLDER).iterdir()
    for bad in ("", "{", '{"map": 3}', '{"joints": [], "map": {"l_hip": "a"}}'):
        file.write_text(bad)
        assert maps.of(["a"]) is None
    assert "is left out" in caplog.text


def test_maps_lie_beside_the_takes_and_are_none(clip, tmp_path):
    sessions = tmp_path / "sessions"
    open_source(f"bvh:{clip}", sessions=sessions, joint_map=joint_map_of(SAID))
    assert SessionLibrary(sessions).list() == []
    assert set(SAID) < set(MAPPABLE)
