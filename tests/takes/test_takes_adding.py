"""Takes from outside: names that fit, zips that lie, other versions, and what is left behind."""

import json
import shutil
import struct
import threading
import zipfile
from pathlib import Path

import numpy as np
import pytest
from acted_takes import acted_take
from make_ticks import make_ticks

from studio.errors import StudioError
from studio.mocap.imports import import_take
from studio.takes.columns import columns
from studio.takes.edit.edits import edit
from studio.takes.export import adding, archive
from studio.takes.record.recorder import Recorder
from studio.takes.session_library import SessionLibrary
from studio.takes.take import read_take, survey_take


@pytest.fixture(scope="module")
def take(tmp_path_factory) -> Path:
    """A take of 60 ticks with an edit."""
    root = tmp_path_factory.mktemp("elsewhere")
    recorder = Recorder(root)
    recorder.start("walk", name="walk")
    for tick in make_ticks(60):
        recorder.append(tick)
    recorder.close()
    edit(root / "walk", label="a walk", keep=True)
    return root / "walk"


def zipped(path: Path, take: Path, *inside: str, **more: bytes) -> Path:
    """A zip with the take's files in each folder `inside`; more: other members."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for folder in inside:
            for file in take.iterdir():
                archive.write(file, f"{folder}/{file.name}" if folder else file.name)
        for name, data in more.items():
            archive.writestr(name, data)
    return path


def everything(root: Path) -> set[str]:
    return {str(p.relative_to(root)) for p in root.rglob("*")}


def test_a_zip_of_takes_is_taken_in_whole_with_its_edits(tmp_path, take):
    sessions = tmp_path / "sessions"
    file = zipped(tmp_path / "two.zip", take, "day/one", "day/two")
    assert import_take(sessions, file) == {"takes": ["one", "two"], "refused": {}}
    (one, two) = SessionLibrary(sessions).list()
    assert (one.label, one.kept, one.ticks) == ("a walk", True, 60)
    assert (two.name, two.complete) == ("two", True)
    assert len(read_take(sessions / "two")) == 60
    assert import_take(sessions, file)["takes"] == ["one-2", "two-2"]


def test_the_files_of_a_take_at_the_top_of_a_zip_are_called_as_the_zip(tmp_path, take):
    file = zipped(tmp_path / "my walk (1).zip", take, "")
    assert import_take(tmp_path / "s", file)["takes"] == ["my-walk-1"]


@pytest.mark.parametrize(
    "inside",
    ["../../out", "/etc/out", "..", "a/../../out", "..\\..\\out", "C:\\out", "datasets", ".hidden"],
)
def test_names_in_a_zip_never_leave_the_sessions_folder(tmp_path, take, inside):
    sessions = tmp_path / "deep" / "sessions"
    (name,) = import_take(sessions, zipped(tmp_path / "z.zip", take, inside))["takes"]
    assert (sessions / name / "tape.mcap").is_file()
    assert everything(tmp_path) - everything(sessions) >= {"z.zip", "deep"}
    outside = {p for p in everything(tmp_path) if not p.startswith("deep/sessions")}
    assert outside == {"z.zip", "deep"}
    assert {p.name for p in sessions.iterdir()} == {name}
    assert name != "datasets"


def test_a_zip_that_unpacks_to_too_much_is_refused_before_the_disk_is_full(tmp_path):
    file = tmp_path / "bomb.zip"
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as out:
        out.writestr("t/tape.mcap", b"\0" * 20_000_000)
    assert file.stat().st_size < 100_000
    (tmp_path / "into").mkdir()
    with pytest.raises(StudioError, match="more than can be taken in"):
        archive.unpack_takes(file, tmp_path / "into", most=1_000_000)
    written = sum(p.stat().st_size for p in (tmp_path / "into").rglob("*") if p.is_file())
    assert written <= 1_000_000


def test_a_zip_that_lists_a_million_members_is_refused_before_they_are_looked_at(tmp_path):
    file = tmp_path / "many.zip"
    entry = struct.pack("<4s6H3L5H2L", b"PK\1\2", 20, 20, *[0] * 7, 1, *[0] * 6)
    listed = (entry + b"a") * 1_000_000
    end = struct.pack("<4s4H2LH", b"PK\5\6", 0, 0, 0xFFFE, 0xFFFE, len(listed), 0, 0)
    file.write_bytes(listed + end)
    with pytest.raises(StudioError, match="lists more members"):
        archive.unpack_takes(file, tmp_path)


@pytest.mark.parametrize("member", ["tape.mcap", "edits.jsonl", "meta.json"])
def test_a_zip_of_zeros_is_refused_before_anything_is_unpacked(tmp_path, take, member, monkeypatch):
    file = zipped(tmp_path / "zeros.zip", take, "good")
    with (
        zipfile.ZipFile(file, "a", zipfile.ZIP_DEFLATED) as out,
        out.open(f"t/{member}", "w") as zeros,
    ):
        for _ in range(100):
            zeros.write(bytes(1 << 20))
    with zipfile.ZipFile(file, "a") as out:
        out.writestr("t/" + ("meta.json" if member == "tape.mcap" else "tape.mcap"), b"{}")
    monkeypatch.setattr(archive, "_copy", pytest.fail)
    with pytest.raises(StudioError, match=f"t/{member} unpacks to 100 MB, more than"):
        import_take(tmp_path / "s", file)
    assert everything(tmp_path / "s") == set()


def test_of_what_is_no_tape_only_the_beginning_is_unpacked(tmp_path, take):
    file = zipped(tmp_path / "z.zip", take, "good", **{"bad/tape.mcap": bytes(30_000_000)})
    (tmp_path / "into").mkdir()
    good, bad = sorted(archive.unpack_takes(file, tmp_path / "into"), key=lambda p: -len(p.name))
    assert (bad / "tape.mcap").stat().st_size < 100
    assert len(read_take(good)) == 60
    assert set(import_take(tmp_path / "s", file)["refused"]) == {"bad"}


@pytest.mark.parametrize(
    "tape", [b"", b"\x89MCAP", b"\x89MCAP0\r\n", b"\x89MCAP0\r\n" + bytes(100)], ids=len
)
@pytest.mark.parametrize("meta", [False, True])
def test_a_take_without_a_tick_is_refused(tmp_path, take, tape, meta):
    empty = tmp_path / "empty"
    empty.mkdir()
    (empty / "tape.mcap").write_bytes(tape)
    if meta:  # that claims sixty
        (empty / "meta.json").write_bytes((take / "meta.json").read_bytes())
    sessions = tmp_path / "s"
    with pytest.raises(StudioError, match="holds no tick"):
        import_take(sessions, empty)
    with pytest.raises(StudioError, match="holds no tick"):
        import_take(sessions, zipped(tmp_path / "z.zip", empty, "empty"))
    with pytest.raises(StudioError, match="holds no tick"):
        import_take(sessions, (empty / "tape.mcap").rename(tmp_path / "one.mcap"))
    assert not sessions.exists() or everything(sessions) <= {".recording.lock"}


def test_a_recording_that_was_stopped_at_once_is_listed_as_damaged(tmp_path):
    recorder = Recorder(tmp_path)
    recorder.start(name="nothing")
    recorder.close()
    (info,) = SessionLibrary(tmp_path).list()
    assert "no tick" in info.damaged


@pytest.mark.parametrize("name", ["deleted", "datasets", "mappers", "Deleted", "-h", "a/b", ""])
def test_no_take_has_a_name_that_is_kept_for_something_else(tmp_path, take, name):
    with pytest.raises(StudioError, match="is no name for a take"):
        SessionLibrary(tmp_path / "s").add(take, name)
    if name and "/" not in name:
        folder = tmp_path / name
        shutil.copytree(take, folder)
        (made,) = import_take(tmp_path / "s", zipped(tmp_path / "z.zip", take, name))["takes"]
        assert made != name


def test_what_is_no_zip_of_takes_is_refused_with_what_would_work(tmp_path, take):
    no_zip = tmp_path / "no.zip"
    no_zip.write_bytes(b"PK but not really")
    with pytest.raises(StudioError, match="no zip that can be read"):
        import_take(tmp_path / "s", no_zip)
    empty = zipped(tmp_path / "empty.zip", take, **{"notes.txt": b"hello"})
    with pytest.raises(StudioError, match=r"a take is a folder with a tape\.mcap"):
        import_take(tmp_path / "s", empty)
    good = zipped(tmp_path / "torn.zip", take, "one").read_bytes()
    (tmp_path / "torn.zip").write_bytes(good[:200] + b"\0" * 64 + good[264:])
    with pytest.raises(StudioError, match="no zip that can be read"):
        import_take(tmp_path / "s", tmp_path / "torn.zip")
    assert not any((tmp_path / "s").glob("*"))


def test_of_several_takes_the_good_ones_are_kept_and_the_others_named(tmp_path, take):
    meta = json.loads((take / "meta.json").read_text())
    newer = json.dumps(meta | {"format_version": 2, "studio_version": "3.1"}).encode()
    file = zipped(
        tmp_path / "z.zip", take, "good",
        **{"new/tape.mcap": (take / "tape.mcap").read_bytes(), "new/meta.json": newer,
           "bad/tape.mcap": b"no tape"},
    )  # fmt: skip
    answer = import_take(tmp_path / "s", file)
    assert answer["takes"] == ["good"]
    assert set(answer["refused"]) == {"new", "bad"}
    assert "recorded with (3.1), export the person there" in answer["refused"]["new"]
    assert "tape.mcap is no tape" in answer["refused"]["bad"]
    assert {p.name for p in (tmp_path / "s").iterdir()} == {"good"}


def frames(path: Path, times) -> Path:
    """A file of human frames of somebody who stands, at these times."""
    pose = acted_take("tilt", np.random.default_rng(0), seconds=1.0).human_pos[0].tolist()
    rows = [{"t": float(t), "skeleton": "studio", "positions": pose} for t in times]
    path.write_text("\n".join(map(json.dumps, rows)))
    return path


def test_a_motion_is_imported_while_a_studio_records_into_the_folder(tmp_path):
    recorder = Recorder(tmp_path / "s")
    recorder.start("live", name="live")
    for tick in make_ticks(5):
        recorder.append(tick)
    file = frames(tmp_path / "my kinect.jsonl", np.arange(40) / 30.0)
    (name,) = import_take(tmp_path / "s", file)["takes"]
    recorder.close()
    found = {take.name: take for take in SessionLibrary(tmp_path / "s").list()}
    assert set(found) == {"live", name}
    assert (found[name].ticks, found[name].label, found[name].complete) == (40, "my-kinect", True)
    assert not list((tmp_path / "s").glob(".import-*"))


def test_a_motion_whose_times_make_no_sense_is_refused_before_it_fills_the_memory(tmp_path):
    file = frames(tmp_path / "x.jsonl", [0.0, 0.1, 1e7])
    with pytest.raises(StudioError, match="more than a take may"):
        import_take(tmp_path / "s", file)


def test_names_are_made_fit_and_free(tmp_path):
    assert adding.free_name(tmp_path, "../my take (é)!") == "my-take"
    (tmp_path / "my-take").mkdir()
    (tmp_path / "my-take-2").symlink_to("nowhere")
    assert adding.free_name(tmp_path, "my take") == "my-take-3"
    assert adding.free_name(tmp_path, "…") == "take"
    assert adding.free_name(tmp_path, "mappers") == "mappers-take"
    assert len(adding.free_name(tmp_path, "x" * 500)) == 100


def test_a_survey_says_what_reading_it_whole_says(take, tmp_path):
    whole, seen = read_take(take), survey_take(take)
    assert (seen.ticks, seen.seconds, seen.complete) == (60, whole.seconds, True)
    torn = tmp_path / "torn"
    torn.mkdir()
    (torn / "tape.mcap").write_bytes((take / "tape.mcap").read_bytes()[:1500])
    whole, seen = read_take(torn), survey_take(torn)
    assert (seen.ticks, seen.complete) == (len(whole), False)
    assert seen.problems == whole.problems


def test_many_who_ask_at_once_get_one_whole_table(tmp_path, take):
    adding.add_take(tmp_path, take, "walk")
    found: list[int] = []

    def ask() -> None:
        found.append(len(columns(tmp_path / "walk").rows["t"]))

    threads = [threading.Thread(target=ask) for _ in range(6)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    assert found == [60] * 6
