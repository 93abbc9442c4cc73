"""Takes to pairs to data set versions: what is in them, and that they cannot change unseen."""

import json
import shutil
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take, record

from studio import geometry
from studio.errors import StudioError
from studio.human.calibration import calibrate
from studio.human.features import clip_features
from studio.human.pose import HumanClip
from studio.reference.intent import STATES
from studio.takes.dataset import datasets, pairs
from studio.takes.dataset.known_counts import KnownCounts
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take
from studio.training.take_pairs import read_pairs

DT = 1.0 / 30.0


@pytest.fixture(scope="module")
def recorded(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("takes")
    rng = np.random.default_rng(1)
    for task in ("tilt", "walk", "sit_manipulate"):
        acted = acted_take(task, rng, seconds=4.0, lag=0.4, idle_gestures=False, sensor="mocap")
        record(acted, root, task, keep=True)
    return root


@pytest.fixture
def library(recorded: Path, tmp_path: Path) -> SessionLibrary:
    shutil.copytree(recorded, tmp_path / "s")
    return SessionLibrary(tmp_path / "s")


def test_pairs_are_the_live_features_of_the_person_at_t_plus_lag(library: SessionLibrary):
    library.edit("tilt", lag=0.4)
    found, take = pairs.take_pairs(library, "tilt"), read_take(library.folder("tilt"))
    assert take.human is not None
    late = HumanClip(
        name="late",
        t=np.float64(DT) * np.arange(len(take) - 12),
        joint_pos_w=take.human.joint_pos_w[12:],
        confidence=take.human.confidence[12:],
    )
    known = calibrate([late[i] for i in range(0, len(late), 10)])
    q, qd, qdd = clip_features(late, known)
    assert found.tick.tolist() == list(range(pairs.SETTLE, len(late)))
    for key, expected in (("q", q), ("qd", qd), ("qdd", qdd)):
        np.testing.assert_allclose(found.values[key], expected[pairs.SETTLE :], atol=2e-3)
    np.testing.assert_allclose(
        found.values["joint_pos"], take.arrays.reference["joint_pos"][found.tick], atol=1e-6
    )


def test_pairs_are_counted_without_being_made(library: SessionLibrary):
    counts = KnownCounts(library)
    for name, state in (("tilt", "stand"), ("walk", "walk"), ("sit_manipulate", "sit")):
        library.edit(name, lag=0.4)
        found = pairs.take_pairs(library, name)
        assert len(found) > 60
        assert counts.of(name) == dict.fromkeys(STATES, 0) | {state: len(found)}
    library.edit("tilt", trim=(0.0, 2.0))
    assert counts.of("tilt")["stand"] == len(pairs.take_pairs(library, "tilt")) == 60 - pairs.SETTLE
    library.edit("tilt", keep=False)
    assert counts.of("tilt")["stand"] == 0


def test_rates_are_backward_differences_over_three_frames(library: SessionLibrary):
    found, take = pairs.take_pairs(library, "walk"), read_take(library.folder("walk"))
    joints, n = take.arrays.reference["joint_pos"], 60
    tick = int(found.tick[n])
    np.testing.assert_allclose(
        found.values["joint_vel"][n], (joints[tick] - joints[tick - 3]) / 0.1, atol=1e-4
    )
    acc = (joints[tick] - 2 * joints[tick - 3] + joints[tick - 6]) / 0.01
    np.testing.assert_allclose(found.values["joint_acc"][n], acc, atol=2e-3)
    assert set(np.unique(found.state)) == {STATES.index("walk")}
    # A walk's contacts: all four stand at rest, feet in the air on the way.
    contact = found.values["contact"]
    assert np.all(contact[0] > 0.99)
    assert contact.min() < 0.05


@pytest.mark.parametrize("task", ["tilt", "walk", "sit_manipulate"])
def test_pairs_do_not_depend_on_where_the_robot_stood_and_faced(task: str, tmp_path: Path):
    acted = acted_take(task, np.random.default_rng(2), seconds=3.0, lag=0.3, sensor="mocap")
    turn = geometry.quat_from_rpy([0.0, 0.0, 2.0])
    motion = acted.motion
    moved = replace(
        motion,
        base_pos=geometry.quat_rotate(turn, motion.base_pos) + [3.0, -1.0, 0.0],
        base_quat=geometry.quat_mul(turn, motion.base_quat),
    )
    record(acted, tmp_path, "here")
    record(replace(acted, motion=moved), tmp_path, "there")
    library = SessionLibrary(tmp_path)
    for name in ("here", "there"):
        library.edit(name, lag=0.3)
    here, there = (pairs.take_pairs(library, n).values for n in ("here", "there"))
    for key in pairs.SHAPES:
        if key != "base_pos":
            tolerance = 0.05 if key.endswith("acc") else 2e-3  # tapes round to a micrometre
            np.testing.assert_allclose(there[key], here[key], atol=tolerance, err_msg=key)


def test_cut_trimmed_and_rejected_frames_are_left_out(library: SessionLibrary):
    library.edit("tilt", lag=0.0)
    whole = pairs.take_pairs(library, "tilt")
    library.edit("tilt", trim=(2.0, 5.0), cuts=[[3.0, 4.0]])
    left = pairs.take_pairs(library, "tilt")
    t = left.tick * DT
    assert np.all((t >= 2.0 - 1e-6) & (t < 5.0) & ~((t > 3.0 - 1e-6) & (t < 4.0 + 1e-6)))
    # What is left is what it was: no filter and no difference starts anew at a cut.
    rows = np.searchsorted(whole.tick, left.tick)
    for key in pairs.SHAPES:
        np.testing.assert_array_equal(left.values[key], whole.values[key][rows])
    library.edit("tilt", keep=False)
    assert len(pairs.take_pairs(library, "tilt")) == 0


def test_the_same_takes_give_the_same_version_and_numbers(library: SessionLibrary, tmp_path: Path):
    first = datasets.build(library)
    shutil.copytree(
        library.root, tmp_path / "copy", ignore=shutil.ignore_patterns("datasets", ".cache")
    )
    again = datasets.build(SessionLibrary(tmp_path / "copy"))
    assert again.version == first.version
    assert again.manifest["content"] == first.manifest["content"]
    assert datasets.content_hash(again.arrays) == datasets.content_hash(first.arrays)
    assert datasets.build(library, ["walk"]).version != first.version
    library.edit("walk", lag=0.1)
    edited = datasets.build(library)
    assert edited.version != first.version
    library.undo("walk")
    assert datasets.build(library).version == first.version
    assert {m["version"] for m in datasets.versions(library.root)} >= {
        first.version,
        edited.version,
    }


def test_notes_and_scores_make_no_new_version(library: SessionLibrary):
    first = datasets.build(library, ["walk"])
    library.edit("walk", note="well done", score=0.9)
    assert datasets.build(library, ["walk"]).version == first.version


def test_the_manifest_says_what_is_in_it(library: SessionLibrary):
    found = datasets.build(library)
    manifest = found.manifest
    assert manifest["count"] == len(found) == sum(t["pairs"] for t in manifest["takes"])
    assert [t["name"] for t in manifest["takes"]] == ["sit_manipulate", "tilt", "walk"]
    assert all(len(t["tape"]) == 64 for t in manifest["takes"])
    for i, state in enumerate(STATES):
        rows = found.of(state)
        stats = manifest["statistics"][state]
        assert stats["count"] == len(rows["tick"]) == int(np.sum(found.arrays["state"] == i))
        np.testing.assert_allclose(
            stats["q"]["mean"], rows["q"].mean(0, dtype=np.float64), atol=1e-5
        )
        np.testing.assert_allclose(stats["joint_pos"]["max"], rows["joint_pos"].max(0), atol=1e-5)


def test_a_version_that_was_changed_is_refused(library: SessionLibrary):
    found = datasets.build(library, ["walk"])
    file = library.root / "datasets" / found.version / "pairs.parquet"
    other = datasets.build(library, ["tilt"])
    shutil.copyfile(library.root / "datasets" / other.version / "pairs.parquet", file)
    with pytest.raises(StudioError, match="not what its manifest says"):
        datasets.load(library.root, found.version)
    file.write_bytes(b"PAR1 nonsense")
    with pytest.raises(StudioError, match="cannot be read"):
        datasets.load(library.root, found.version)


@pytest.mark.parametrize(
    "change",
    [
        lambda m: m.update(style="circles"),
        lambda m: m["takes"][0].update(name="tilt"),
        lambda m: m["takes"][0]["edits"].update(lag=0.7),
        lambda m: m.update(states=["walk"]),
    ],
)
def test_a_manifest_that_was_edited_is_refused(library: SessionLibrary, change):
    found = datasets.build(library, ["walk"])
    file = library.root / "datasets" / found.version / "manifest.json"
    manifest = json.loads(file.read_text())
    file.write_text(json.dumps(manifest))
    assert datasets.load(library.root, found.version).manifest == manifest
    change(manifest)
    file.write_text(json.dumps(manifest))
    with pytest.raises(StudioError, match="was changed: delete its folder and build it again"):
        datasets.load(library.root, found.version)


def test_a_version_of_another_format_says_what_to_do(library: SessionLibrary):
    found = datasets.build(library, ["walk"])
    file = library.root / "datasets" / found.version / "manifest.json"
    file.write_text(json.dumps(json.loads(file.read_text()) | {"format_version": 2}))
    with pytest.raises(StudioError, match="build it again"):
        datasets.load(library.root, found.version)


def test_unknown_takes_states_and_versions_name_the_known(library: SessionLibrary):
    with pytest.raises(StudioError, match="sit_manipulate, tilt, walk"):
        datasets.build(library, ["jump"])
    with pytest.raises(StudioError, match="sit, stand, walk"):
        datasets.build(library, states=["fly"])
    with pytest.raises(StudioError, match="none yet"):
        datasets.load(library.root, "0123")
    with pytest.raises(StudioError, match="no pair"):
        datasets.build(library, ["walk"], states=["sit"])


def test_walking_in_another_style_is_refused_with_what_would_work(library: SessionLibrary):
    for task in ("tilt", "walk"):
        acted = acted_take(task, np.random.default_rng(3), seconds=3.0, lag=0.2, sensor="mocap")
        record(acted, library.root, f"{task}-round", keep=True, style="circles")
    with pytest.raises(StudioError, match=r"in walk-round: train with --style circles, or leave"):
        datasets.build(library)
    # Standing is the same in every style, and a take that does not say may be any.
    datasets.build(library, ["tilt-round", "walk"])
    datasets.build(library, states=["stand", "sit"])
    found = datasets.build(library, ["walk-round"], style="circles")
    with pytest.raises(StudioError, match="in style circles, not march, in data set"):
        read_pairs(library.root, (), found.version)
    assert read_pairs(library.root, (), found.version, "circles").count("walk")
    assert read_pairs(library.root, (), found.version, walk=False).count("walk")
    with pytest.raises(StudioError, match="--style circles"):
        read_pairs(library.root, ("walk-round",))
    read_pairs(library.root, ("walk-round", "tilt"), walk=False)
    library.edit("walk-round", keep=False)
    datasets.build(library, ["walk", "walk-round"])


def test_the_folder_of_data_sets_is_no_take(library: SessionLibrary):
    datasets.build(library, ["walk"])
    assert [info.name for info in library.list()] == ["sit_manipulate", "tilt", "walk"]
    with pytest.raises(StudioError, match="no name for a take"):
        library.folder("datasets")
