"""Many takes at once, the bin, pictures and scores; what is exported as it is comes back."""

import os
import xml.etree.ElementTree as ET
import zipfile
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take, record

from studio.errors import StudioError
from studio.mocap.imports import import_take, take_in
from studio.takes import bin, many
from studio.takes.columns import columns
from studio.takes.edit.edits import Edits, edit, read_edits
from studio.takes.export.many import export_many, of_session
from studio.takes.session_library import SessionLibrary
from studio.takes.sessions import SessionBook
from studio.takes.thumbnail import key_of, telling_row, thumbnails

TASKS = {"a": "tilt", "b": "walk", "c": "manipulate_left"}


@pytest.fixture
def library(tmp_path: Path) -> SessionLibrary:
    """Three takes of three seconds."""
    for i, (name, task) in enumerate(TASKS.items()):
        record(acted_take(task, np.random.default_rng(i), seconds=4.0), tmp_path / "s", name)
    return SessionLibrary(tmp_path / "s")


def test_each_of_many_is_done_by_itself_and_the_refused_say_why(library: SessionLibrary):
    kept = many.act(library.root, ["a", "nobody", "b"], "keep")
    assert kept.done == ["a", "b"]
    assert "unknown take 'nobody'" in kept.refused["nobody"]
    assert [t.kept for t in library.list()] == [True, True, None]
    many.act(library.root, ["a"], "undecided")
    assert library.info("a").kept is None
    gone = many.act(library.root, ["a", "c", "../c"], "delete")
    assert gone.done == ["a", "c"]
    assert list(gone.refused) == ["../c"]
    assert [t.name for t in library.list()] == ["b"]
    back = many.act_in_bin(library.root, gone.binned, "restore")
    assert back.done == gone.binned
    assert [t.name for t in library.list()] == ["a", "b", "c"]


def test_the_bin_says_what_it_holds_and_gives_the_space_back(library: SessionLibrary):
    tape = library.root / "a" / "tape.mcap"
    size = sum(f.stat().st_size for f in (library.root / "a").iterdir())
    assert size > tape.stat().st_size
    edit(library.root / "a", label="hello")
    size += (library.root / "a" / "edits.jsonl").stat().st_size
    first = many.act(library.root, ["a"], "delete").binned[0]
    (found,) = bin.contents(library.root)
    assert (found.place, found.bytes) == (first, size)
    assert (found.take.name, found.take.label) == ("a", "hello")
    assert found.take.seconds == pytest.approx(library.info("b").seconds, abs=2.0)
    # Another take of that name, deleted too: each has a place of its own.
    os.rename(library.root / "b", library.root / "a")
    second = many.act(library.root, ["a"], "delete").binned[0]
    assert [one.place for one in bin.contents(library.root)] == [first, second]
    bin.bring_back_from(library.root, first)
    assert library.info("a").label == "hello"
    with pytest.raises(StudioError, match="exists"):
        bin.bring_back_from(library.root, second)
    bin.delete_for_good(library.root, second)
    assert bin.contents(library.root) == []


@pytest.mark.parametrize("place", ["a", "../a", "a.20260101-000000-00000x", "", "../s/a", "a/b"])
def test_no_place_leads_out_of_the_bin(library: SessionLibrary, place: str):
    (library.root / ".bin").mkdir()
    for work in (bin.delete_for_good, bin.bring_back_from):
        with pytest.raises(StudioError, match="nothing lies"):
            work(library.root, place)
    link = library.root / ".bin" / "b.20260101-000000-000000"
    link.symlink_to(library.root / "b")
    with pytest.raises(StudioError, match="nothing lies"):
        bin.delete_for_good(library.root, link.name)
    assert (library.root / "b" / "tape.mcap").is_file()


def test_a_half_of_a_take_frees_no_tape_that_the_other_half_needs(library: SessionLibrary):
    _, half = library.split("a", 1.5)
    many.act(library.root, [half.name], "delete")
    (found,) = bin.contents(library.root)
    assert 0 < found.bytes < (library.root / "a" / "tape.mcap").stat().st_size


def test_a_picture_shows_the_figures_at_the_instant_that_moves_most(library: SessionLibrary):
    drawn, refused = thumbnails(library.root, ["a", "b", "c", "nobody"])
    assert list(drawn) == ["a", "b", "c"]
    assert "unknown" in refused["nobody"]
    for svg in drawn.values():
        root = ET.fromstring(svg)
        assert root.get("viewBox") == "0 0 200 100"
        strokes = [node.get("stroke") for node in root.iter() if node.get("stroke")]
        assert len(set(strokes)) == 3
        numbers = svg.replace("M", " ").replace("L", " ").replace("Z", " ")
        assert "nan" not in numbers
        assert len(svg) < 3000
    table = columns(library.root / "c")
    i = telling_row(table, Edits())
    joints = np.asarray(table.rows["reference_joint_pos"], dtype=np.float64)
    rest = np.abs(joints - np.median(joints, axis=0)).sum(1)
    assert rest[i] > np.percentile(rest, 90)
    early = telling_row(table, Edits(trim=(0.0, 1.0)))
    assert early < 30


def test_a_take_in_the_bin_has_the_picture_it_had(library: SessionLibrary):
    before, _ = thumbnails(library.root, ["a"])
    (place,) = many.act(library.root, ["a"], "delete").binned
    gone = "b.20260101-000000-000000"
    drawn, refused = thumbnails(library.root, [place, gone, "../a", "a"])
    assert drawn == {place: before["a"]}
    assert "nothing lies" in refused[gone]
    assert set(refused) == {gone, "../a", "a"}


def test_a_picture_is_drawn_anew_only_where_tape_or_edits_changed(library: SessionLibrary):
    folder = library.root / "a"
    before = key_of(folder)
    os.utime(folder)
    assert key_of(folder) == before
    edit(folder, trim=(0.0, 1.0))
    assert key_of(folder) != before
    with pytest.raises(StudioError, match="no tape"):
        key_of(library.root / "nobody")


def test_every_take_is_given_a_score_and_what_somebody_gave_stays(library: SessionLibrary):
    edit(library.root / "b", score=0.123)
    found, refused = many.scores(library.root, ["a", "b", "nobody"])
    assert found["b"] == 0.123
    assert 0.0 <= found["a"] <= 1.0
    assert list(refused) == ["nobody"]
    assert library.info("a").score == found["a"]


def test_a_session_is_exported_as_it_is_and_comes_back(library: SessionLibrary, tmp_path: Path):
    edit(library.root / "a", label="up", trim=(0.5, 2.0))
    edit(library.root / "b", keep=False)
    for name in TASKS:
        SessionBook(library.root).add("Ann", name)
    (session,) = SessionBook(library.root).list()
    names, seen = of_session(library, session.name), []
    made = export_many(
        library.root, names, "takes", tmp_path, session.name, rejected=False, at=seen.append
    )
    assert seen == [0, 1, 2, 3]
    assert made.takes == 2
    assert made.left_out == {"b": "it was rejected"}
    assert made.file.name == f"{session.name}.takes.zip"
    answer = take_in(tmp_path / "t", [made.file], None)
    assert answer["takes"] == ["a", "c"]
    for name in ("a", "c"):
        assert read_edits(tmp_path / "t" / name).edits == read_edits(library.root / name).edits
        tapes = [
            (root / name / "tape.mcap").read_bytes() for root in (library.root, tmp_path / "t")
        ]
        assert tapes[0] == tapes[1]


def test_takes_that_come_back_are_in_the_session_they_were_recorded_in(tmp_path: Path):
    here, there = tmp_path / "here", tmp_path / "there"
    acted = acted_take("tilt", np.random.default_rng(0), seconds=2.0)
    for name, session in (("a", "ann-20261001"), ("b", "ann-20261001"), ("c", "../../ann")):
        record(acted, here, name, session=session)
    made = export_many(here, ["a", "b", "c"], "takes", tmp_path, "all")
    record(acted, there, "a", session="")  # called alike, of no session
    assert take_in(there, [made.file], None)["takes"] == ["a-2", "b", "c"]
    (session,) = SessionBook(there).list()
    assert (session.name, session.operator) == ("ann-20261001", "me")
    assert session.takes == ["a-2", "b"]
    assert of_session(SessionLibrary(there), "ann-20261001") == ["a-2", "b"]


def test_a_format_of_one_take_becomes_a_zip_of_a_file_each(library: SessionLibrary, tmp_path: Path):
    made = export_many(library.root, ["a", "b", "nobody"], "bvh", tmp_path, "some")
    assert made.takes == 2
    assert list(made.left_out) == ["nobody"]
    assert zipfile.ZipFile(made.file).namelist() == ["a.bvh", "b.bvh"]
    assert sorted(path.name for path in tmp_path.iterdir()) == ["s", "some-bvh.zip"]
    made = export_many(library.root, ["a", "b"], "lerobot", tmp_path, "set")
    with zipfile.ZipFile(made.file) as archive:
        archive.extractall(tmp_path / "out")
    back = import_take(tmp_path / "t", tmp_path / "out" / "set.lerobot")
    assert len(back["takes"]) == 2
    with pytest.raises(StudioError, match="nothing to export"):
        export_many(library.root, ["nobody"], "bvh", tmp_path, "none")
    with pytest.raises(StudioError, match="unknown format"):
        export_many(library.root, ["a"], "pdf", tmp_path, "none")
